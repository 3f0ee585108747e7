//! A naive reader of the numbers in VTK files: base64 of blocks that zlib packed (RFC 1950 and 1951).

use std::collections::HashMap;

/// Six bits per letter, most significant first.
fn base64(text: &str) -> Vec<u8> {
    let alphabet = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut bytes = Vec::new();
    let (mut bits, mut count) = (0_u32, 0);
    for letter in text.trim_end_matches('=').chars() {
        bits = bits << 6 | alphabet.find(letter).unwrap() as u32;
        count += 6;
        if count >= 8 {
            count -= 8;
            bytes.push((bits >> count) as u8);
            bits &= (1 << count) - 1;
        }
    }
    bytes
}

/// The bytes of an array from the text between its tags: how many blocks there are, their size, that of a last one that is shorter, the sizes of
/// all when packed; behind that, encoded anew, the blocks.
pub(crate) fn unpacked(text: &str) -> Vec<u8> {
    let text = text.trim();
    let words = |bytes: &[u8]| -> Vec<usize> {
        let (words, rest) = bytes.as_chunks::<8>();
        assert!(rest.is_empty());
        words
            .iter()
            .map(|&w| u64::from_le_bytes(w) as usize)
            .collect()
    };
    let blocks = words(&base64(&text[..32]))[0];
    let (head, data) = text.split_at((8 * (3 + blocks)).div_ceil(3) * 4);
    let head = words(&base64(head));
    let (size, last) = (head[1], head[2]);
    let mut data = &base64(data)[..];
    let mut bytes = Vec::new();
    for (k, &packed) in head[3..].iter().enumerate() {
        let (block, rest) = data.split_at(packed);
        let block = inflate(block);
        let is_short = k + 1 == blocks && last > 0;
        assert_eq!(block.len(), if is_short { last } else { size });
        bytes.extend(block);
        data = rest;
    }
    assert!(data.is_empty());
    bytes
}

/// Bits of bytes, least significant first.
struct Bits<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl Bits<'_> {
    fn bit(&mut self) -> usize {
        let bit = self.bytes[self.at / 8] >> (self.at % 8) & 1;
        self.at += 1;
        bit.into()
    }

    fn number(&mut self, bits: usize) -> usize {
        (0..bits).map(|k| self.bit() << k).sum()
    }

    fn symbol(&mut self, codes: &HashMap<(usize, usize), usize>) -> usize {
        let (mut length, mut code) = (0, 0);
        loop {
            (length, code) = (length + 1, code << 1 | self.bit());
            if let Some(&symbol) = codes.get(&(length, code)) {
                return symbol;
            }
            assert!(length < 16, "no code");
        }
    }
}

/// The canonical codes with these lengths.
fn codes(lengths: &[usize]) -> HashMap<(usize, usize), usize> {
    let mut codes = HashMap::new();
    let mut code = 0;
    for length in 1..16 {
        for (symbol, _) in lengths.iter().enumerate().filter(|(_, l)| **l == length) {
            codes.insert((length, code), symbol);
            code += 1;
        }
        code <<= 1;
    }
    codes
}

/// Unpacks the data of zlib.
fn inflate(packed: &[u8]) -> Vec<u8> {
    assert_eq!(packed[0] & 15, 8, "deflate");
    assert_eq!(
        (256 * usize::from(packed[0]) + usize::from(packed[1])) % 31,
        0
    );
    let mut bits = Bits {
        bytes: &packed[2..],
        at: 0,
    };
    let mut out: Vec<u8> = Vec::new();
    loop {
        let is_last = bits.bit() == 1;
        match bits.number(2) {
            0 => {
                bits.at = bits.at.next_multiple_of(8);
                let (length, complement) = (bits.number(16), bits.number(16));
                assert_eq!(length + complement, 0xffff);
                out.extend((0..length).map(|_| bits.number(8) as u8));
            }
            1 => {
                let runs = [(144, 8), (112, 9), (24, 7), (8, 8)];
                let lengths: Vec<usize> = runs.iter().flat_map(|&(n, l)| vec![l; n]).collect();
                compressed(&mut bits, &codes(&lengths), &codes(&[5; 30]), &mut out);
            }
            2 => {
                let (literals, distances) = (bits.number(5) + 257, bits.number(5) + 1);
                let mut order = [0; 19];
                let count = bits.number(4) + 4;
                let places = [
                    16, 17, 18, 0, 8, 7, 9, 6, 10, 5, 11, 4, 12, 3, 13, 2, 14, 1, 15,
                ];
                for &place in &places[..count] {
                    order[place] = bits.number(3);
                }
                let of_lengths = codes(&order);
                let mut lengths = Vec::new();
                while lengths.len() < literals + distances {
                    let (length, times) = match bits.symbol(&of_lengths) {
                        16 => (lengths[lengths.len() - 1], 3 + bits.number(2)),
                        17 => (0, 3 + bits.number(3)),
                        18 => (0, 11 + bits.number(7)),
                        length => (length, 1),
                    };
                    lengths.extend(vec![length; times]);
                }
                let (literals, distances) = lengths.split_at(literals);
                compressed(&mut bits, &codes(literals), &codes(distances), &mut out);
            }
            _ => panic!("no such block"),
        }
        if is_last {
            break;
        }
    }
    let (mut a, mut b) = (1_u32, 0_u32);
    for &byte in &out {
        a = (a + u32::from(byte)) % 65521;
        b = (b + a) % 65521;
    }
    let sum = bits.at.div_ceil(8);
    assert_eq!(bits.bytes[sum..], (b << 16 | a).to_be_bytes());
    out
}

/// Literals, and pieces of what came before.
fn compressed(
    bits: &mut Bits<'_>,
    literals: &HashMap<(usize, usize), usize>,
    distances: &HashMap<(usize, usize), usize>,
    out: &mut Vec<u8>,
) {
    // The first value and the further bits of each symbol.
    let ranges = |first: usize, growing: usize, count: usize| -> Vec<(usize, usize)> {
        let mut next = first;
        let bits = |k: usize| (k / growing).saturating_sub(1);
        let range = |k| {
            let from = next;
            next += 1 << bits(k);
            (from, bits(k))
        };
        (0..count).map(range).collect()
    };
    let mut lengths = ranges(3, 4, 28);
    lengths.push((258, 0));
    let far = ranges(1, 2, 30);
    loop {
        match bits.symbol(literals) {
            256 => return,
            symbol if symbol < 256 => out.push(symbol as u8),
            symbol => {
                let (from, more) = lengths[symbol - 257];
                let length = from + bits.number(more);
                let (from, more) = far[bits.symbol(distances)];
                let distance = from + bits.number(more);
                for _ in 0..length {
                    out.push(out[out.len() - distance]);
                }
            }
        }
    }
}
