//! Content hash.

use std::fmt::{self, Write};

use sha2::{Digest, Sha256};

/// Hexadecimal digits of the hash of a formatted text.
pub(crate) fn digest(written: fmt::Arguments<'_>, digits: usize) -> String {
    let mut hash = Hash(Sha256::new());
    write!(hash, "{written}").expect("a hash takes everything");
    let mut text = hexadecimal(&hash.0.finalize());
    text.truncate(digits);
    text
}

/// All hexadecimal digits of the SHA-256 of bytes.
pub(crate) fn digest_of(bytes: &[u8]) -> String {
    hexadecimal(&Sha256::digest(bytes))
}

fn hexadecimal(bytes: &[u8]) -> String {
    let mut text = String::with_capacity(2 * bytes.len());
    for byte in bytes {
        write!(text, "{byte:02x}").expect("room for digits");
    }
    text
}

/// Writer that hashes its input piece by piece.
struct Hash(Sha256);

impl Write for Hash {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        self.0.update(text.as_bytes());
        Ok(())
    }
}
