//! What a problem file asks for, done.

use std::time::Instant;

use crate::app::error::CommandError;
use crate::app::forward;
use crate::app::progress::Progress;
use crate::app::request::{CommandInput, CommandOutput};
use crate::app::rest;
use crate::app::solve;
use crate::control::problem::Task;
use crate::files::read_problem;
use crate::workflow::accuracy::AccuracyTarget;
use crate::workflow::memory;
use crate::workflow::phase::phase;

/// Reads a problem and does what it asks: optimal control, simulation or equilibrium.
///
/// # Errors
/// The input is wrong, and nothing was written; or the results cannot be written.
pub fn run(request: &CommandInput) -> Result<CommandOutput, CommandError> {
    let began = Instant::now();
    let _progress = Progress::of_phases(request.progress);
    phase("reading");
    let loaded = read_problem(&request.input, &request.set)?;
    memory::of_elements(&loaded.system).map_err(CommandError::of(&request.input))?;
    refuse_unused(request, &loaded.task)?;
    match loaded.task {
        Task::Control(control) => solve::control(request, &loaded.system, &control, began),
        Task::Simulate(simulation) => {
            forward::simulation(request, &loaded.system, &simulation, began)
        }
        Task::Equilibrium(task) => rest::at(request, &loaded.system, &task, began),
    }
}

/// Refuses options that the task has no use for.
fn refuse_unused(request: &CommandInput, task: &Task) -> Result<(), CommandError> {
    let option = match (task, request.wanted) {
        (Task::Equilibrium(_), Some(AccuracyTarget::Below(_))) => "--accuracy",
        (Task::Equilibrium(_), Some(AccuracyTarget::Estimate)) => "--estimate-error",
        (Task::Equilibrium(_) | Task::Simulate(_), _) if request.max_iterations.is_some() => {
            "--max-iterations"
        }
        _ => return Ok(()),
    };
    let asks = match task {
        Task::Equilibrium(_) if request.wanted.is_some() => {
            "an equilibrium, which has no steps in time to refine"
        }
        Task::Equilibrium(_) => "an equilibrium, for which no solver of programs iterates",
        _ => "a simulation, for which no solver of programs iterates",
    };
    Err(CommandError::Option {
        option,
        reason: format!("{} asks for {asks}", request.input.display()),
    })
}
