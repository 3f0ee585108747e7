//! `solution.json`, of a long motion with `solution.npz` beside it.

use std::fs;
use std::path::Path;

use crate::control::Solution;
use crate::files::solution::{Written, written};
use crate::model::Model;
use crate::report::atomic::{self, WriteError};
use crate::report::file_set::FileSet;

/// The file of a result.
pub(super) const NAME: &str = "solution.json";
/// That of a solve that has not ended.
pub(super) const UNFINISHED: &str = "unfinished.json";
/// Its arrays.
pub(super) const ARRAYS: &str = "solution.npz";

/// Writes a solution as files of a result.
///
/// # Errors
/// A file cannot be written.
pub(super) fn add(files: &mut FileSet, model: &Model, solved: &Solution) -> Result<(), WriteError> {
    let texts = written(model, solved, ARRAYS);
    let Written { json, arrays } = texts.map_err(|cause| WriteError {
        path: files.folder().join(ARRAYS),
        cause,
    })?;
    match arrays {
        Some(bytes) => files.add(ARRAYS, &bytes)?,
        None => files.remove(ARRAYS),
    }
    files.add(NAME, json.as_bytes())
}

/// Writes a solution by itself.
///
/// # Errors
/// A file cannot be written.
pub(super) fn write(path: &Path, model: &Model, solved: &Solution) -> Result<(), WriteError> {
    let beside = path.with_extension("npz");
    let name = beside.file_name().unwrap_or_default().to_string_lossy();
    let texts = written(model, solved, &name);
    let Written { json, arrays } = texts.map_err(|cause| WriteError {
        path: beside.clone(),
        cause,
    })?;
    if let Some(bytes) = &arrays {
        atomic::write(&beside, bytes)?;
    }
    atomic::write(path, json.as_bytes())
}

/// Removes a solution that was written by itself.
pub(super) fn remove(path: &Path) {
    fs::remove_file(path).ok();
    fs::remove_file(path.with_extension("npz")).ok();
}
