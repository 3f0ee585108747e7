//! `solution.json`.

use std::path::Path;

use crate::control::Solution;
use crate::files::solution;
use crate::model::Model;
use crate::report::atomic::{self, WriteError};

/// Writes a solution.
///
/// # Errors
/// The file cannot be written.
pub(super) fn write(path: &Path, model: &Model, solved: &Solution) -> Result<(), WriteError> {
    atomic::write(path, solution::text(model, solved).as_bytes())
}
