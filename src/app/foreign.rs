//! Detection of results of another problem in the folder to which results are to be written.

use std::fs;
use std::path::{Component, Path, PathBuf};

use serde::Deserialize;

use crate::app::error::CommandError;
use crate::app::request::CommandInput;

/// Entries of a summary that name the source of its results.
#[derive(Deserialize)]
struct Summary {
    input: PathBuf,
}

/// Refuses to replace the results of another problem file, unless their folder was named: then it says so before anything is done.
///
/// # Errors
/// The folder that was not named has results of another problem file.
pub(super) fn refuse_foreign(request: &CommandInput) -> Result<(), CommandError> {
    let folder = request.folder();
    let text = fs::read_to_string(folder.join("summary.json")).ok();
    let summary = text.and_then(|text| serde_json::from_str::<Summary>(&text).ok());
    let Some(Summary { input }) = summary.filter(|there| !is_same(&there.input, &request.input))
    else {
        return Ok(());
    };
    if request.output.is_none() {
        return Err(CommandError::Foreign {
            folder,
            input,
            own: request.input.clone(),
        });
    }
    let (folder, input) = (folder.display(), input.display());
    tracing::warn!("{folder} has results of {input}, which this run replaces");
    Ok(())
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
        Err(_) => own.ends_with(plain(before)),
    }
}

/// A path without `.`, and without `..` behind a folder.
fn plain(path: &Path) -> PathBuf {
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
