//! The folder of the results.

use std::fs;
use std::path::Path;

use crate::report::atomic::{self, WriteError};

/// Makes the folder of the results, or removes the files that killed runs left half written.
pub(crate) fn make_folder(folder: &Path) -> Result<(), WriteError> {
    fs::create_dir_all(folder).map_err(|cause| WriteError {
        path: folder.to_owned(),
        cause,
    })?;
    atomic::tidy(folder);
    Ok(())
}
