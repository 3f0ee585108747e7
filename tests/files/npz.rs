//! Arrays read back as they were, and what is no such file is refused.

use std::fs;
use std::io::{Cursor, Write};
use std::path::PathBuf;

use proboscis::files::npz::{self, NpzError, NpzWriter};
use tempfile::TempDir;
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, ZipWriter};

/// Rows, a list, an array of three indices, and a text.
fn example() -> (Vec<u8>, String) {
    let mut arrays = NpzWriter::default();
    let rows: Vec<Vec<f64>> = (0..5).map(|k| vec![0.1 * f64::from(k), -1e300]).collect();
    arrays.rows("state/z", &rows);
    arrays.list("voltages/Muskel ä", &[f64::MIN_POSITIVE, f64::NAN, -0.0]);
    arrays.array("cube", &[2, 1, 3], (0..6).map(f64::from));
    arrays.list("none", &[]);
    arrays.text("problem.json", "{}");
    arrays.finish().unwrap()
}

fn file(bytes: &[u8]) -> (TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.npz");
    fs::write(&path, bytes).unwrap();
    (folder, path)
}

#[test]
fn arrays_read_back_identical() {
    let (bytes, digits) = example();
    let (_folder, path) = file(&bytes);
    let read = npz::read(&path, |_| true).unwrap();
    let array = |name: &str| read.arrays[name].clone();
    assert_eq!(read.digits, digits);
    assert_eq!(array("state/z").shape, [5, 2]);
    assert_eq!(array("state/z").values[8..], [0.1 * 4.0, -1e300]);
    let bits: Vec<u64> = array("voltages/Muskel ä")
        .values
        .iter()
        .map(|x| x.to_bits())
        .collect();
    let expected = [f64::MIN_POSITIVE, f64::NAN, -0.0].map(f64::to_bits);
    assert_eq!(bits, expected);
    assert_eq!(array("cube").shape, [2, 1, 3]);
    assert_eq!(array("cube").values, [0.0, 1.0, 2.0, 3.0, 4.0, 5.0]);
    assert_eq!(array("none").shape, [0]);
    assert_eq!(read.texts["problem.json"], "{}");
    let some = npz::read(&path, |name| name == "cube").unwrap();
    assert_eq!(some.arrays.keys().collect::<Vec<_>>(), ["cube"]);
    assert_eq!(some.digits, digits);
    let mut other = NpzWriter::default();
    other.list("none", &[1.0]);
    assert_ne!(other.finish().unwrap().1, digits);
}

/// The format as NumPy's documentation gives it, byte by byte: numbers begin at a multiple of 64.
#[test]
fn an_array_stands_as_numpy_reads_it() {
    let mut arrays = NpzWriter::default();
    arrays.rows("z", &[vec![1.5, -2.0]]);
    let (bytes, _) = arrays.finish().unwrap();
    let begin = bytes
        .windows(8)
        .position(|w| w == b"\x93NUMPY\x01\x00")
        .unwrap();
    let array = &bytes[begin..];
    let length = usize::from(u16::from_le_bytes([array[8], array[9]]));
    assert_eq!((10 + length) % 64, 0);
    let header = std::str::from_utf8(&array[10..10 + length]).unwrap();
    assert_eq!(
        header.trim_end(),
        "{'descr': '<f8', 'fortran_order': False, 'shape': (1, 2,), }"
    );
    assert!(header.ends_with('\n'));
    assert_eq!(array[10 + length..][..8], 1.5_f64.to_le_bytes());
    assert_eq!(array[18 + length..][..8], (-2.0_f64).to_le_bytes());
}

#[test]
fn a_damaged_file_is_refused_and_nothing_panics() {
    let (bytes, digits) = example();
    let (_folder, path) = file(&bytes);
    for end in 0..bytes.len() {
        fs::write(&path, &bytes[..end]).unwrap();
        assert!(npz::read(&path, |_| true).is_err(), "{end} bytes");
    }
    let mut changed = 0;
    for at in 0..bytes.len() {
        let mut bytes = bytes.clone();
        bytes[at] ^= 0x15;
        fs::write(&path, &bytes).unwrap();
        if let Ok(read) = npz::read(&path, |_| true) {
            // Dates and the like may change, but no number of the arrays.
            changed += 1;
            if read.digits == digits {
                assert!(read.arrays.values().all(|a| a.values.len() <= 10));
            }
        }
    }
    assert!(changed < bytes.len() / 2, "{changed} of {}", bytes.len());
}

/// The bytes of a file with one array `a` of this header and these numbers.
fn with_header(header: &str, numbers: &[u8]) -> Vec<u8> {
    let mut member = b"\x93NUMPY\x01\x00".to_vec();
    member.extend((header.len() as u16).to_le_bytes());
    member.extend(header.as_bytes());
    member.extend(numbers);
    let mut archive = ZipWriter::new(Cursor::new(Vec::new()));
    let options = SimpleFileOptions::default().compression_method(CompressionMethod::Stored);
    archive.start_file("a.npy", options).unwrap();
    archive.write_all(&member).unwrap();
    archive.finish().unwrap().into_inner()
}

#[test]
fn arrays_of_other_numbers_and_shapes_are_refused() {
    let header = |descr: &str, order: &str, shape: &str| {
        format!("{{'descr': '{descr}', 'fortran_order': {order}, 'shape': {shape}, }}\n")
    };
    let numbers = [1.0_f64, 2.0].map(f64::to_le_bytes).concat();
    let read = |header: &str, numbers: &[u8]| {
        let (_folder, path) = file(&with_header(header, numbers));
        npz::read(&path, |_| true)
    };
    let right = read(&header("<f8", "False", "(2,)"), &numbers).unwrap();
    assert_eq!(right.arrays["a"].values, [1.0, 2.0]);
    let none = read(&header("<f8", "False", "(0, 3)"), &[]).unwrap();
    assert_eq!(none.arrays["a"].shape, [0, 3]);
    for (descr, order, shape, numbers) in [
        ("<f4", "False", "(4,)", &numbers[..]),
        (">f8", "False", "(2,)", &numbers),
        ("<i8", "False", "(2,)", &numbers),
        ("<f8", "True", "(1, 2)", &numbers),
        ("<f8", "False", "(3,)", &numbers),
        ("<f8", "False", "(1,)", &numbers),
        ("<f8", "False", "(2,)", &numbers[..15]),
        ("<f8", "False", "(-2,)", &numbers),
        ("<f8", "False", "(2", &numbers),
        ("<f8", "False", "(0, 99999999999999)", &[]),
        ("<f8", "False", "(4294967296, 4294967296, 4294967296)", &[]),
    ] {
        let found = read(&header(descr, order, shape), numbers);
        assert!(
            matches!(&found, Err(NpzError::NoNumbers(name)) if name == "a"),
            "{descr} {order} {shape}: {found:?}"
        );
    }
}

/// Two arrays that change places are other contents.
#[test]
fn digits_tell_which_array_is_which() {
    let of = |a: f64, b: f64| {
        let mut arrays = NpzWriter::default();
        arrays.list("a", &[a]);
        arrays.list("b", &[b]);
        arrays.finish().unwrap().1
    };
    assert_eq!(of(1.0, 2.0), of(1.0, 2.0));
    assert_ne!(of(1.0, 2.0), of(2.0, 1.0));
    assert_ne!(of(1.0, 1.0), of(2.0, 2.0));
}

#[test]
fn names_that_an_archive_cannot_have_are_errors() {
    let mut twice = NpzWriter::default();
    twice.list("a", &[]);
    twice.list("a", &[]);
    assert!(twice.finish().is_err());
    let mut long = NpzWriter::default();
    long.list(&"a".repeat(70_000), &[]);
    assert!(long.finish().is_err());
    let nowhere = npz::read(&PathBuf::from("nowhere.npz"), |_| true);
    assert!(matches!(nowhere, Err(NpzError::Unreadable(_))));
}
