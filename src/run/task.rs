//! What a problem file asks for, done.

use std::time::Instant;

use crate::control::problem::Task;
use crate::run::accuracy::Wanted;
use crate::run::error::RunError;
use crate::run::memory;
use crate::run::progress::{Progress, phase};
use crate::run::request::{Request, Told};
use crate::run::{forward, rest, solve};
use crate::scene::read_problem;

/// Reads a problem and does what it asks: optimal control, simulation or equilibrium.
///
/// # Errors
/// The input is wrong, and nothing was written; or the results cannot be written.
pub fn run(request: &Request) -> Result<Told, RunError> {
    let began = Instant::now();
    let _progress = Progress::of_phases(request.progress);
    phase("reading");
    let loaded = read_problem(&request.input, &request.set)?;
    memory::of_elements(&request.input, &loaded.system)?;
    match loaded.task {
        Task::Control(control) => solve::control(request, &loaded.system, &control, began),
        Task::Simulate(simulation) => {
            forward::simulation(request, &loaded.system, &simulation, began)
        }
        Task::Equilibrium(task) => {
            refuse_wanted(request)?;
            let asked = rest::Asked {
                system: &loaded.system,
                task: &task,
                folder: Some(request.folder()),
            };
            rest::at(request, &asked, began)
        }
    }
}

/// An equilibrium has no grid in time.
fn refuse_wanted(request: &Request) -> Result<(), RunError> {
    let option = match request.wanted {
        None => return Ok(()),
        Some(Wanted::Below(_)) => "--accuracy",
        Some(Wanted::Estimate) => "--estimate-error",
    };
    Err(RunError::Option {
        option,
        reason: format!(
            "{} asks for an equilibrium, which has no steps in time to refine",
            request.input.display()
        ),
    })
}
