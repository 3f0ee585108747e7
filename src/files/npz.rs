//! Arrays of numbers in one file, as NumPy keeps them (`numpy.load`): a ZIP archive whose members are arrays in the format NPY 1.0, not
//! compressed, and texts.
//!
//! Format: NumPy Enhancement Proposal 1.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::{self, Cursor, Read, Seek, Write};
use std::path::Path;

use zip::result::ZipError;
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, ZipArchive, ZipWriter};

/// First bytes of an array: the name of the format and its version.
const MAGIC: &[u8] = b"\x93NUMPY\x01\x00";
/// Numbers begin at a multiple of this number of bytes.
const ALIGNED: usize = 64;
/// Ends the names of arrays.
const ARRAY: &str = ".npy";

/// Numbers in rows: the last index changes fastest.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Array {
    /// Length along each index.
    pub shape: Vec<usize>,
    /// As many numbers as the product of the lengths.
    pub values: Vec<f64>,
}

/// Reason why a file is no archive of arrays.
#[derive(Debug, thiserror::Error)]
pub enum NpzError {
    /// It cannot be read.
    #[error("cannot be read: {0}")]
    Unreadable(#[from] io::Error),
    /// It is no archive, or compressed.
    #[error("no archive of arrays as numpy.savez writes it: {0}")]
    NoArchive(#[from] ZipError),
    /// A member is no array of 64-bit numbers.
    #[error("{0:?} is no array of 64-bit numbers in rows")]
    NoNumbers(String),
    /// A member is no text.
    #[error("{0:?} is no text")]
    NoText(String),
}

/// Contents of a file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Npz {
    /// By their names.
    pub arrays: BTreeMap<String, Array>,
    /// By their names.
    pub texts: BTreeMap<String, String>,
    /// Digits that other contents most likely do not have.
    pub digits: String,
}

/// The bytes of a file.
#[derive(Debug)]
pub struct NpzWriter {
    archive: ZipWriter<Cursor<Vec<u8>>>,
    room: Vec<u8>,
    failure: Option<ZipError>,
}

impl Default for NpzWriter {
    fn default() -> Self {
        Self {
            archive: ZipWriter::new(Cursor::default()),
            room: Vec::new(),
            failure: None,
        }
    }
}

impl NpzWriter {
    /// Adds an array of this shape.
    ///
    /// # Panics
    /// There are not as many values as the shape says.
    pub fn array(&mut self, name: &str, shape: &[usize], values: impl Iterator<Item = f64>) {
        let mut lengths: String = shape.iter().map(|length| format!("{length}, ")).collect();
        lengths.truncate(lengths.trim_end().len());
        let mut header =
            format!("{{'descr': '<f8', 'fortran_order': False, 'shape': ({lengths}), }}");
        let begin = MAGIC.len() + 2;
        let end = (begin + header.len() + 1).next_multiple_of(ALIGNED);
        header.extend(std::iter::repeat_n(' ', end - begin - header.len() - 1));
        header.push('\n');
        let length = u16::try_from(header.len()).expect("few indices");
        let mut room = std::mem::take(&mut self.room);
        room.clear();
        room.extend_from_slice(MAGIC);
        room.extend_from_slice(&length.to_le_bytes());
        room.extend_from_slice(header.as_bytes());
        let count: usize = shape.iter().product();
        room.reserve(8 * count);
        values.for_each(|value| room.extend_from_slice(&value.to_le_bytes()));
        assert_eq!(room.len(), end + 8 * count, "values of {name:?}");
        self.member(&format!("{name}{ARRAY}"), &room);
        self.room = room;
    }

    /// Adds an array with one row for each item.
    ///
    /// # Panics
    /// Rows differ in length.
    pub fn rows(&mut self, name: &str, rows: &[Vec<f64>]) {
        let shape = [rows.len(), rows.first().map_or(0, Vec::len)];
        self.array(name, &shape, rows.iter().flatten().copied());
    }

    /// Adds a list of numbers.
    pub fn list(&mut self, name: &str, values: &[f64]) {
        self.array(name, &[values.len()], values.iter().copied());
    }

    /// Adds a text.
    pub fn text(&mut self, name: &str, text: &str) {
        self.member(name, text.as_bytes());
    }

    fn member(&mut self, name: &str, bytes: &[u8]) {
        let options = SimpleFileOptions::default()
            .compression_method(CompressionMethod::Stored)
            .large_file(u32::try_from(bytes.len()).is_err());
        let begun = self.archive.start_file(name, options);
        let written = begun.and_then(|()| Ok(self.archive.write_all(bytes)?));
        if let (Err(error), None) = (written, &self.failure) {
            self.failure = Some(error);
        }
    }

    /// The bytes, and the digits of their contents.
    ///
    /// # Errors
    /// A name occurs twice, or is too long for an archive.
    pub fn finish(self) -> io::Result<(Vec<u8>, String)> {
        if let Some(error) = self.failure {
            return Err(error.into());
        }
        let bytes = self.archive.finish()?.into_inner();
        let digits = digits(&mut ZipArchive::new(Cursor::new(&bytes))?)?;
        Ok((bytes, digits))
    }
}

/// Reads a file, those arrays whose names are wanted.
///
/// # Errors
/// It is none, or a member is neither array nor text.
pub fn read(path: &Path, is_wanted: impl Fn(&str) -> bool) -> Result<Npz, NpzError> {
    let file = File::open(path)?;
    let most = usize::try_from(file.metadata()?.len()).unwrap_or(usize::MAX);
    let mut archive = ZipArchive::new(io::BufReader::new(file))?;
    let mut read = Npz {
        digits: digits(&mut archive)?,
        ..Npz::default()
    };
    for index in 0..archive.len() {
        let mut member = archive.by_index(index)?;
        let name = member.name()?.into_owned();
        let array = name.strip_suffix(ARRAY);
        if array.is_some_and(|name| !is_wanted(name)) {
            continue;
        }
        let mut bytes = Vec::new();
        member.read_to_end(&mut bytes)?;
        match array {
            Some(name) => {
                let array = parse(&bytes, most);
                let array = array.ok_or_else(|| NpzError::NoNumbers(name.to_owned()))?;
                read.arrays.insert(name.to_owned(), array);
            }
            None => {
                let text = String::from_utf8(bytes);
                let text = text.map_err(|_| NpzError::NoText(name.clone()))?;
                read.texts.insert(name, text);
            }
        }
    }
    Ok(read)
}

/// The checksums of all members in one number.
fn digits<R: Read + Seek>(archive: &mut ZipArchive<R>) -> Result<String, ZipError> {
    let mut sum = 0_u64;
    for index in 0..archive.len() {
        let member = archive.by_index_raw(index)?;
        sum = sum.wrapping_mul(0x0100_0000_01b3) ^ u64::from(member.crc32());
    }
    Ok(format!("{sum:016x}"))
}

/// An array none of whose lengths is above `most`.
fn parse(bytes: &[u8], most: usize) -> Option<Array> {
    let rest = bytes.strip_prefix(MAGIC)?;
    let (length, rest) = rest.split_first_chunk::<2>()?;
    let (header, numbers) = rest.split_at_checked(usize::from(u16::from_le_bytes(*length)))?;
    let header = std::str::from_utf8(header).ok()?;
    let is_plain = header.contains("'descr': '<f8'") && header.contains("'fortran_order': False");
    let (_, shape) = header.split_once("'shape': (").filter(|_| is_plain)?;
    let (shape, _) = shape.split_once(')')?;
    let lengths = shape.split(',').map(str::trim).filter(|l| !l.is_empty());
    let shape: Vec<usize> = lengths.map(|l| l.parse().ok()).collect::<Option<_>>()?;
    let (numbers, rest) = numbers.as_chunks::<8>();
    let count = shape.iter().try_fold(1_usize, |all, &l| all.checked_mul(l));
    let fits = rest.is_empty() && count == Some(numbers.len()) && shape.iter().all(|&l| l <= most);
    fits.then(|| Array {
        shape,
        values: numbers.iter().map(|&n| f64::from_le_bytes(n)).collect(),
    })
}
