//! Message that names the command for the task of a problem, where another one was typed.

use crate::app::error::CommandError;
use crate::app::messages::key;
use crate::app::request::CommandInput;
use crate::control::problem::Task;
use crate::report::shell;

/// Refuses a problem that asks for something else than a motion under given voltages.
pub(super) fn refuse_all_but_motions(
    request: &CommandInput,
    task: &Task,
) -> Result<(), CommandError> {
    let reason = match task {
        Task::Simulate(_) => return Ok(()),
        Task::Control(_) | Task::Motions(_) => format!(
            "asks for optimal voltages, found by `{}`; a motion under given voltages is asked for by \"simulate\" in place of \"control\"",
            command(request, "solve")
        ),
        Task::Identify(_) => format!(
            "asks for constants, found by `{}`",
            command(request, "solve")
        ),
        Task::Equilibrium(_) => format!(
            "asks for a state of rest, found by `{}`",
            command(request, "equilibrium")
        ),
    };
    Err(command_error(request, task, reason))
}

/// The refusal of a problem that asks for no state of rest.
pub(super) fn no_equilibrium(request: &CommandInput, task: &Task) -> CommandError {
    let (asks, word) = match task {
        Task::Control(_) | Task::Motions(_) => ("optimal voltages", "solve"),
        Task::Identify(_) => ("constants", "solve"),
        _ => ("a motion", "simulate"),
    };
    let reason = format!(
        "asks for {asks}, found by `{}`, and for no equilibrium; for that of its scene name the voltages with --voltages",
        command(request, word)
    );
    command_error(request, task, reason)
}

fn command_error(request: &CommandInput, task: &Task, reason: String) -> CommandError {
    CommandError::Problem {
        file: request.input.clone(),
        place: key(task).to_owned(),
        reason,
    }
}

/// A command on the same problem with the same overrides and folder.
fn command(request: &CommandInput, word: &str) -> String {
    let mut words = vec!["proboscis".to_owned(), word.to_owned()];
    words.push(request.input.display().to_string());
    let set = request.set.iter();
    words.extend(set.flat_map(|set| ["--set".to_owned(), set.clone()]));
    if let Some(folder) = &request.output {
        words.extend(["-o".to_owned(), folder.display().to_string()]);
    }
    shell::command(words)
}
