//! Results side by side on one page, made from the pages of their folders.

use std::fs;
use std::path::{Path, PathBuf};

use crate::app::error::CommandError;
use crate::app::folder::make_folder;
use crate::app::request::CommandOutput;
use crate::report::atomic;
use crate::report::origin::Origin;
use crate::report::page::compared;

/// Name of the page of a result.
pub(super) const PAGE: &str = "report.html";

/// Writes `report.html` into `output`, which compares the results of some folders.
///
/// # Errors
/// A folder has no page of a result, or the page cannot be written.
pub fn compare(
    command: &str,
    folders: &[PathBuf],
    output: &Path,
) -> Result<CommandOutput, CommandError> {
    let page = html(command, folders, &[])?;
    // Its own page would be replaced by that of all.
    let place = |folder: &Path| fs::canonicalize(folder).ok();
    let is_own = |folder: &&PathBuf| place(folder).is_some_and(|it| place(output) == Some(it));
    if let Some(own) = folders.iter().find(is_own) {
        return Err(CommandError::Option {
            option: "--output",
            reason: format!(
                "found {}, one of the results, expected another folder: its report.html is that of a run",
                own.display()
            ),
        });
    }
    make_folder(output)?;
    let file = output.join(PAGE);
    atomic::write(&file, page.as_bytes())?;
    Ok(CommandOutput {
        is_solved: true,
        result: file.display().to_string(),
        notes: Vec::new(),
    })
}

/// The page that compares the results of some folders, whose names lead to `pages` of their own.
///
/// # Errors
/// A folder has no page of a result.
pub(super) fn html(
    command: &str,
    folders: &[PathBuf],
    pages: &[String],
) -> Result<String, CommandError> {
    let wrong = |reason| CommandError::Option {
        option: "RESULT",
        reason,
    };
    let mut results = Vec::new();
    for (folder, name) in folders.iter().zip(names(folders)) {
        let file = folder.join(PAGE);
        let html = fs::read_to_string(&file).map_err(|cause| {
            wrong(format!(
                "cannot read {}: {cause}; a run writes it unless --no-report is given",
                file.display()
            ))
        })?;
        let data = compared::data(&html).ok_or_else(|| {
            wrong(format!(
                "{} is no whole page of a result of this version",
                file.display()
            ))
        })?;
        results.push((name, data));
    }
    let origin = Origin {
        command: command.to_owned(),
        version: Origin::program(),
        ..Origin::default()
    };
    Ok(compared::html(&results, pages, &origin))
}

/// The last parts of the paths where all differ, otherwise the whole paths.
fn names(folders: &[PathBuf]) -> Vec<String> {
    let last = |folder: &PathBuf| Some(folder.file_name()?.to_string_lossy().into_owned());
    let names: Option<Vec<String>> = folders.iter().map(last).collect();
    let differ = |all: &Vec<String>| (1..all.len()).all(|i| !all[..i].contains(&all[i]));
    let whole = || {
        folders
            .iter()
            .map(|folder| folder.display().to_string())
            .collect()
    };
    names.filter(differ).unwrap_or_else(whole)
}
