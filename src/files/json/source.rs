//! The bytes of a JSON file, if the machine has room for what is read from them.

use serde::de::IgnoredAny;
use serde_json::Value;
use std::fs::File;
use std::io::{self, Read};
use std::path::Path;
use std::sync::{Mutex, PoisonError};

use crate::math::join::{available, readable};

/// Bytes of memory that reading takes for each byte of a file: its text, and for a value in a list, which has 4 bytes or more in the file, 32 bytes
/// of its node, half as many while the list grows, and 16 bytes of the number or the text that it is.
const OF_BYTE: f64 = 17.0;
/// Bytes of the largest file where the memory of the machine is not known, and where it is: places in a text are numbers of 32 bits.
const LARGEST: [u64; 2] = [1 << 30, 1 << 31];

/// Bytes from standard input. A process reads it once: several starts have the same problem.
static STANDARD_INPUT: Mutex<Option<Vec<u8>>> = Mutex::new(None);

/// Reason why there are no bytes.
#[derive(Debug)]
pub(crate) enum NoBytes {
    /// Error of the operating system.
    Unreadable(io::Error),
    /// Size that was found, and the size expected.
    TooLarge(String, String),
}

/// Returns true if a file that is typed stands for standard input.
pub(crate) fn is_standard_input(path: &Path) -> bool {
    path == Path::new("-")
}

/// The bytes of a file.
pub(crate) fn of_file(path: &Path) -> Result<Vec<u8>, NoBytes> {
    let file = File::open(path).map_err(NoBytes::Unreadable)?;
    let size = file.metadata().map_or(0, |found| found.len());
    limited(file, size)
}

/// The bytes of standard input.
pub(crate) fn of_standard_input() -> Result<Vec<u8>, NoBytes> {
    let mut read = STANDARD_INPUT
        .lock()
        .unwrap_or_else(PoisonError::into_inner);
    if let Some(bytes) = &*read {
        return Ok(bytes.clone());
    }
    let bytes = limited(io::stdin().lock(), 0)?;
    Ok(read.insert(bytes).clone())
}

/// Reads all, if there is room for it; a `size` that is known is checked first.
fn limited(from: impl Read, size: u64) -> Result<Vec<u8>, NoBytes> {
    let free = available();
    let most = free.map_or(LARGEST[0], |free| (free / OF_BYTE) as u64);
    let most = most.min(LARGEST[1]);
    let too_large = |found: String| {
        let of_memory = free.map_or_else(String::new, |free| {
            let free = readable(free);
            format!(": reading takes up to {OF_BYTE} bytes for each byte of a file, and {free} of memory are free")
        });
        let expected = format!("a file of at most {}{of_memory}", readable(most as f64));
        NoBytes::TooLarge(found, expected)
    };
    if size > most {
        return Err(too_large(format!("a file of {}", readable(size as f64))));
    }
    let mut bytes = Vec::with_capacity(size as usize);
    let mut from = from.take(most + 1);
    from.read_to_end(&mut bytes).map_err(NoBytes::Unreadable)?;
    match bytes.len() as u64 > most {
        true => Err(too_large("a file without a known end".to_owned())),
        false => Ok(bytes),
    }
}

/// A text without the byte-order mark that some editors write before it.
pub(crate) fn unmarked(mut text: String) -> String {
    if let Some(rest) = text.strip_prefix('\u{feff}') {
        text = rest.to_owned();
    }
    text
}

/// Checks that a text is JSON, whose numbers may be too large.
///
/// # Errors
/// The first error in it.
pub(crate) fn check_json(text: &str) -> Result<(), serde_json::Error> {
    // A value that is ignored takes less time and memory, but its escapes are not decoded, and the columns of its mistakes are other ones.
    match !text.contains("\\u") && serde_json::from_str::<IgnoredAny>(text).is_ok() {
        true => Ok(()),
        false => serde_json::from_str::<Value>(text).map(drop),
    }
}
