//! Detection of results of another problem in the folder to which results are to be written.

use crate::app::error::CommandError;
use crate::app::kept::record::WrittenSummary;
use crate::app::request::CommandInput;
use crate::report::atomic;
use crate::report::atomic::WriteError;
use std::fs;
use std::path::{Component, Path, PathBuf};

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
