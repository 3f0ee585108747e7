//! `solution.json`, of a long motion with `solution.npz` next to it.

use std::fs;
use std::path::{Path, PathBuf};

use crate::control::Solution;
use crate::files::solution::{self, Written};
use crate::model::Model;
use crate::report::atomic::{self, WriteError};
use crate::report::file_set::FileSet;

/// The file of a result.
pub(in crate::app) const NAME: &str = "solution.json";
/// Its arrays.
pub(in crate::app) const ARRAYS: &str = "solution.npz";
/// The file of a solve that has not ended.
pub(in crate::app) const UNFINISHED: &str = "unfinished.json";

/// Writes a solution as files of a result.
///
/// # Errors
/// A file cannot be written.
pub(in crate::app) fn add(
    files: &mut FileSet,
    model: &Model,
    solved: &Solution,
) -> Result<(), WriteError> {
    let texts = solution::written(model, solved, ARRAYS);
    let Written { json, arrays } = texts.map_err(WriteError::at(files.folder().join(ARRAYS)))?;
    files.put(ARRAYS, arrays)?;
    files.add(NAME, json.as_bytes())
}

/// Replaces a solution that stands by itself in one step: whenever the program is killed, the file and the arrays that it names are of one solution.
///
/// The arrays take the name that the file does not give. Those before stay until the next time, for who has just read the file.
///
/// # Errors
/// A file cannot be written.
pub(in crate::app) fn replace(
    path: &Path,
    model: &Model,
    solved: &Solution,
) -> Result<(), WriteError> {
    let before = solution::file_beside(path).map(|name| path.with_file_name(name));
    let [first, second] = arrays_beside(path);
    let beside = match before.as_ref() == Some(&first) {
        true => second,
        false => first,
    };
    let name = beside.file_name().unwrap_or_default().to_string_lossy();
    let texts = solution::written(model, solved, &name);
    let Written { json, arrays } = texts.map_err(WriteError::at(&beside))?;
    if let Some(bytes) = &arrays {
        atomic::write(&beside, bytes)?;
    }
    atomic::write(path, json.as_bytes())
}

/// Removes a solution that stands by itself.
pub(in crate::app) fn remove(path: &Path) {
    fs::remove_file(path).ok();
    for arrays in arrays_beside(path) {
        fs::remove_file(arrays).ok();
    }
}

/// The two files that its arrays stand in by turns.
fn arrays_beside(path: &Path) -> [PathBuf; 2] {
    ["1.npz", "2.npz"].map(|ending| path.with_extension(ending))
}
