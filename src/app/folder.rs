//! The folder of the results.

use std::fs;
use std::path::{Path, PathBuf};

use crate::app::foreign::replaced;
use crate::app::request::CommandInput;
use crate::report::atomic::{self, WriteError};

/// Makes the folder of the results of a run, and warns where those of another problem are replaced.
pub(super) fn make_folder_of(request: &CommandInput) -> Result<PathBuf, WriteError> {
    if let Some(words) = replaced(request) {
        tracing::warn!("{words}");
    }
    let folder = request.folder();
    make_folder(&folder)?;
    Ok(folder)
}

/// Makes the folder of the results, or removes the files that killed runs left half written.
pub(crate) fn make_folder(folder: &Path) -> Result<(), WriteError> {
    fs::create_dir_all(folder).map_err(|cause| WriteError {
        path: folder.to_owned(),
        cause,
    })?;
    atomic::tidy(folder);
    Ok(())
}
