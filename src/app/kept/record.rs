//! The result that a folder has: its summary as other runs read it, its files as they were written, by their sizes and hashes, and whether it is of
//! another problem than that of the result to be written.

use crate::app::error::CommandError;
use crate::app::request::CommandInput;
use crate::report::atomic;
use crate::report::atomic::WriteError;
use crate::workflow::Remarks;
use crate::workflow::remark::STOPPED_EARLY;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};
use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::{Component, Path, PathBuf};
use std::{fmt, fs, io};

/// Statuses that may be otherwise the next time.
const UNFINISHED: [&str; 5] = [
    "not_started",
    "interrupted",
    "time_limit",
    "failed",
    "out_of_memory",
];

/// Entries of a `summary.json` that other runs read.
#[derive(Debug, Default, Deserialize)]
pub(crate) struct WrittenSummary {
    /// The problem file as typed.
    pub(crate) input: PathBuf,
    pub(crate) status: String,
    #[serde(default)]
    pub(crate) notes: Remarks,
    pub(crate) objective: Option<f64>,
    pub(crate) iterations: Option<usize>,
    pub(crate) infeasibility: Option<f64>,
    pub(crate) seconds: WrittenSeconds,
    /// Motions with summaries of their own.
    #[serde(default)]
    pub(crate) motions: Vec<WrittenMotion>,
}

/// Wall time of a run in s.
#[derive(Debug, Default, Deserialize)]
pub(crate) struct WrittenSeconds {
    pub(crate) total: f64,
}

/// One of several motions, and its folder within that of the result.
#[derive(Debug, Deserialize)]
pub(crate) struct WrittenMotion {
    pub(crate) name: String,
    pub(crate) folder: PathBuf,
}

impl WrittenSummary {
    /// The summary of the run whose results a folder has.
    pub(crate) fn of_folder(folder: &Path) -> Option<Self> {
        parsed(&folder.join("summary.json"))
    }

    /// Returns true if another attempt may end otherwise: the run failed, or a stop kept it from a better result.
    pub(crate) fn is_unfinished(&self) -> bool {
        UNFINISHED.contains(&&*self.status) || self.notes.have(STOPPED_EARLY)
    }
}

/// The value in a JSON file; none where it cannot be read.
pub(crate) fn parsed<T: DeserializeOwned>(path: &Path) -> Option<T> {
    serde_json::from_str(&fs::read_to_string(path).ok()?).ok()
}

/// A file.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
struct FileRecord {
    bytes: u64,
    sha256: String,
}

/// The files of a folder and its folders, by their paths within it.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(transparent)]
pub(super) struct FileRecords(BTreeMap<String, FileRecord>);

impl FileRecords {
    /// The files that a folder has now, without a `record` of them and unfinished files.
    pub(super) fn from_folder(folder: &Path, record: &str) -> io::Result<Self> {
        let mut files = BTreeMap::new();
        for path in files_within(folder)? {
            let name = path.file_name().unwrap_or_default().to_string_lossy();
            if name.starts_with('.') || path == Path::new(record) {
                continue;
            }
            let bytes = fs::read(folder.join(&path))?;
            let record = FileRecord {
                bytes: bytes.len() as u64,
                sha256: digest_of(&bytes),
            };
            files.insert(path.to_string_lossy().into_owned(), record);
        }
        Ok(Self(files))
    }

    /// The first file that is not as it was written, in words.
    pub(super) fn deviation(&self, folder: &Path) -> Option<String> {
        let mut files = self.0.iter();
        files.find_map(|(name, record)| {
            let path = folder.join(name);
            let bytes = match fs::metadata(&path) {
                Ok(found) => found.len(),
                Err(_) => return Some(format!("{name} is missing")),
            };
            if bytes != record.bytes {
                return Some(format!("{name} has {bytes} of {} bytes", record.bytes));
            }
            match fs::read(&path) {
                Ok(bytes) if digest_of(&bytes) == record.sha256 => None,
                Ok(_) => Some(format!("{name} has been changed")),
                Err(cause) => Some(format!("{name} cannot be read ({cause})")),
            }
        })
    }
}

/// The paths within a folder of its files and of those in its folders.
pub(in crate::app) fn files_within(folder: &Path) -> io::Result<Vec<PathBuf>> {
    let mut files = Vec::new();
    for entry in fs::read_dir(folder)? {
        let path = entry?.path();
        let name = PathBuf::from(path.file_name().unwrap_or_default());
        match path.is_dir() {
            true => files.extend(files_within(&path)?.iter().map(|inner| name.join(inner))),
            false => files.push(name),
        }
    }
    Ok(files)
}

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

/// Refuses to replace the results of another problem file, unless their folder was named.
///
/// # Errors
/// The folder that was not named has results of another problem file.
pub(in crate::app) fn refuse_foreign(request: &CommandInput) -> Result<(), CommandError> {
    match foreign(request) {
        Some(input) if request.output.is_none() => Err(CommandError::Foreign {
            folder: request.folder(),
            input,
            own: request.input.clone(),
        }),
        _ => Ok(()),
    }
}

/// A warning that results of another problem file are replaced, for a run whose input is right.
pub(in crate::app) fn replaced(request: &CommandInput) -> Option<String> {
    let (folder, input) = (request.folder(), foreign(request)?);
    let (folder, input) = (folder.display(), input.display());
    Some(format!(
        "{folder} has results of {input}, which this run replaces"
    ))
}

/// The other problem file whose results the folder of a run has.
fn foreign(request: &CommandInput) -> Option<PathBuf> {
    let WrittenSummary { input, .. } = WrittenSummary::of_folder(&request.folder())?;
    (!is_same(&input, &request.input)).then_some(input)
}

/// Returns true if two paths as typed, the first one maybe elsewhere, name one file.
fn is_same(before: &Path, now: &Path) -> bool {
    if before == now {
        return true;
    }
    let Ok(own) = now.canonicalize() else {
        return false;
    };
    match before.canonicalize() {
        Ok(other) => other == own,
        // It was typed in another folder.
        Err(_) => own.ends_with(without_dots(before)),
    }
}

/// A path without `.`, and without `..` behind a folder.
pub(crate) fn without_dots(path: &Path) -> PathBuf {
    let mut plain = PathBuf::new();
    for part in path.components() {
        match part {
            Component::CurDir => {}
            Component::ParentDir if plain.file_name().is_some() => {
                plain.pop();
            }
            part => plain.push(part),
        }
    }
    plain
}

/// Makes the folder of the results of a run, and warns where those of another problem are replaced.
pub(in crate::app) fn make_folder_of(request: &CommandInput) -> Result<PathBuf, WriteError> {
    if let Some(words) = replaced(request) {
        tracing::warn!("{words}");
    }
    let folder = request.folder();
    make_folder(&folder)?;
    Ok(folder)
}

/// The folder of a motion within that of the results, which is that of one without a name.
pub(in crate::app) fn folder_within(results: &Path, name: &str) -> PathBuf {
    match name {
        "" => results.to_owned(),
        name => results.join(name),
    }
}

/// Makes the folder of the results, or removes the files that killed runs left half written.
pub(crate) fn make_folder(folder: &Path) -> Result<(), WriteError> {
    fs::create_dir_all(folder).map_err(WriteError::at(folder))?;
    atomic::tidy(folder);
    Ok(())
}
