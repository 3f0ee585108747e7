//! `solution.json`.

use std::path::Path;

use crate::control::Solution;
use crate::files::solution;
use crate::model::Model;
use crate::report::atomic::{self, WriteError};
use crate::report::file_set::FileSet;

/// The file of a result.
pub(super) const NAME: &str = "solution.json";

/// Writes a solution as one of the files of a result.
///
/// # Errors
/// The file cannot be written.
pub(super) fn add(files: &mut FileSet, model: &Model, solved: &Solution) -> Result<(), WriteError> {
    files.add(NAME, solution::text(model, solved).as_bytes())
}

/// Writes a solution by itself.
///
/// # Errors
/// The file cannot be written.
pub(super) fn write(path: &Path, model: &Model, solved: &Solution) -> Result<(), WriteError> {
    atomic::write(path, solution::text(model, solved).as_bytes())
}
