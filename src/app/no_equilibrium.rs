//! Result of a run that finds no state of rest to begin with, to end with, or at all, or no optimum that its controller follows: its summary alone.

use crate::app::error::CommandError;
use crate::app::folder::make_folder_of;
use crate::app::left_out::EARLIER;
use crate::app::request::{CommandInput, CommandOutput};
use crate::app::summary::Summary;
use crate::dynamics::EquilibriumError;
use crate::report::file_set::FileSet;

/// The status of such a run.
const STATUS: &str = "no_equilibrium";
/// That of one whose controller has no optimum to follow.
const UNSOLVED: &str = "plan_unsolved";

/// Writes the summary of a run that has ended so, and gives its answer back.
///
/// # Errors
/// Those of the run; or the summary cannot be written.
pub(super) fn kept<T>(
    request: &CommandInput,
    answer: Result<T, CommandError>,
) -> Result<T, CommandError> {
    match &answer {
        Err(CommandError::NoEquilibrium { place, reason, .. }) => {
            write(request, STATUS, &format!("{place}: {reason}"))?;
        }
        Err(CommandError::Unsolved { place, reason, .. }) => {
            write(request, UNSOLVED, &format!("{place}: {reason}"))?;
        }
        _ => {}
    }
    answer
}

/// Writes the summary alone, with a status and its reason.
///
/// # Errors
/// It cannot be written.
pub(super) fn write(
    request: &CommandInput,
    status: &'static str,
    reason: &str,
) -> Result<(), CommandError> {
    let folder = make_folder_of(request)?;
    let mut summary = Summary::new(request, status, None);
    summary.message = Some(reason.to_owned());
    let mut files = FileSet::in_folder(&folder);
    EARLIER.iter().for_each(|name| files.remove(name));
    Ok(summary.write(files)?)
}

/// Handles a missing equilibrium: a floating block is wrong input, anything else a result of which the summary alone is written.
pub(super) fn refused(
    request: &CommandInput,
    error: &EquilibriumError,
    result: &str,
) -> Result<CommandOutput, CommandError> {
    match error {
        EquilibriumError::Floating { .. } => {
            return Err(CommandError::Problem {
                file: request.input.clone(),
                place: "equilibrium".to_owned(),
                reason: error.to_string(),
            });
        }
        EquilibriumError::Stopped(status) => return Err(CommandError::Stopped(*status)),
        _ => {}
    }
    write(request, STATUS, &error.to_string())?;
    Ok(CommandOutput {
        is_solved: false,
        result: format!("{result}, {}", request.folder().display()),
        notes: vec![error.to_string()],
    })
}
