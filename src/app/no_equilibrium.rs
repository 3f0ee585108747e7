//! Result of a run that finds no state of rest to begin with, to end with, or at all, or no optimum that its controller follows: its summary alone.

use crate::app::error::CommandError;
use crate::app::kept::overwrite_check::make_folder_of;
use crate::app::kept::partial_result::EARLIER;
use crate::app::request::{CommandInput, CommandOutput, key};
use crate::app::summary::Summary;
use crate::control::problem::Task;
use crate::dynamics::EquilibriumError;
use crate::report::file_set::FileSet;
use crate::report::quoting;

/// Writes the summary of a run that has ended so, and gives its answer back.
///
/// # Errors
/// Those of the run; or the summary cannot be written.
pub(super) fn kept<T>(
    request: &CommandInput,
    answer: Result<T, CommandError>,
) -> Result<T, CommandError> {
    if let Err(error @ CommandError::InFile { error: reason, .. }) = &answer
        && let Some(status) = error.unanswered()
    {
        write(request, status, &reason.to_string())?;
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
            return Err(CommandError::problem(
                &request.input,
                "equilibrium",
                error.to_string(),
            ));
        }
        EquilibriumError::Stopped(stopped) => return Err((*stopped).into()),
        _ => {}
    }
    write(request, "no_equilibrium", &error.to_string())?;
    Ok(CommandOutput {
        is_solved: false,
        result: format!("{result}, {}", request.folder().display()),
        notes: vec![error.to_string()],
    })
}

/// Refuses a problem that asks for something else than a motion under given voltages.
pub(super) fn refuse_all_but_motions(
    request: &CommandInput,
    task: &Task,
) -> Result<(), CommandError> {
    let (asks, word, instead) = match task {
        Task::Simulate(_) => return Ok(()),
        Task::Control(_) | Task::Motions(_) => (
            "optimal voltages",
            "solve",
            "; a motion under given voltages is asked for by \"simulate\" in place of \"control\"",
        ),
        Task::Identify(_) => ("constants", "solve", ""),
        Task::Equilibrium(_) => ("a state of rest", "equilibrium", ""),
    };
    Err(asks_for(request, task, [asks, word, instead]))
}

/// The refusal of a problem that asks for no state of rest.
pub(super) fn no_equilibrium(request: &CommandInput, task: &Task) -> CommandError {
    let (asks, word) = match task {
        Task::Control(_) | Task::Motions(_) => ("optimal voltages", "solve"),
        Task::Identify(_) => ("constants", "solve"),
        _ => ("a motion", "simulate"),
    };
    let instead =
        ", and for no equilibrium; for that of its scene name the voltages with --voltages";
    asks_for(request, task, [asks, word, instead])
}

/// The refusal of a problem that asks for something else, with the word of the command that finds it.
fn asks_for(request: &CommandInput, task: &Task, [asks, word, instead]: [&str; 3]) -> CommandError {
    let found = quoting::command(request.words(word));
    let reason = format!("asks for {asks}, found by `{found}`{instead}");
    CommandError::problem(&request.input, key(task), reason)
}
