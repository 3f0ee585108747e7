//! A simulation in memory.

use std::ops::ControlFlow;
use std::time::Instant;

use crate::control::problem::Simulation;
use crate::control::resolve_start;
use crate::dynamics::{DiscreteTrajectory, StepControl, StepError, simulate_by, simulate_within};
use crate::ipopt::interrupt;
use crate::model::{Model, System};
use crate::workflow::error::WorkflowError;
use crate::workflow::memory;
use crate::workflow::phase::phase;

/// A simulation and how it ended.
#[derive(Debug)]
pub struct Simulated {
    /// The model that moved.
    pub model: Model,
    /// The motion as far as it went.
    pub history: DiscreteTrajectory,
    /// Why it ended early.
    pub failure: Option<StepError>,
    /// Seconds before the first step.
    pub setup: f64,
    /// Seconds in the steps.
    pub seconds: f64,
}

/// Number of steps of a simulation, and their length in ms.
///
/// The steps are equal: as long as asked for, or a little shorter where they do not fit the duration.
///
/// Where a tolerance controls the steps their number is not known, and the length is that of the first attempt.
pub fn grid(task: &Simulation) -> (usize, f64) {
    if task.tolerance.is_some() {
        return (usize::MAX, task.step);
    }
    let steps = (task.duration / task.step - 1e-9).ceil().max(1.0) as usize;
    (steps, task.duration / steps as f64)
}

/// Simulates what a file asks for in memory; after every step `observer` sees the motion so far and may end it.
///
/// # Errors
/// The model or the start does not exist. A step that fails is no error: see the failure.
pub fn integrate(
    system: &System,
    task: &Simulation,
    mut observer: impl FnMut(&Model, &DiscreteTrajectory) -> ControlFlow<()>,
) -> Result<Simulated, WorkflowError> {
    let began = Instant::now();
    let (steps, h) = grid(task);
    let wrong = |error| WorkflowError::boundary("simulate", &error);
    phase("building");
    let model = Model::answering(system.clone(), task.question(system, h))
        .map_err(|error| wrong(error.into()))?;
    if task.tolerance.is_none() {
        memory::of_motion(&model, steps)?;
    }
    if let Some(status) = interrupt::stop() {
        return Err(WorkflowError::Stopped(status));
    }
    phase("finding the start");
    let start = resolve_start(&model, &task.start, "start").map_err(wrong)?;
    let setup = began.elapsed().as_secs_f64();
    phase("ordering and first factorisation");
    let observer = |history: &DiscreteTrajectory| observer(&model, history);
    let scalars = |from: f64, to: f64| model.scalars(&task.voltages.at(0.5 * (from + to)));
    let switches = task.voltages.switches();
    let (history, failure) = match task.tolerance {
        Some(tolerance) => {
            let control = StepControl {
                duration: task.duration,
                first: h,
                tolerance,
                switches: &switches,
            };
            simulate_within(task.solving, &model, &start, control, scalars, observer)
        }
        None => simulate_by(task.solving, &model, &start, h, steps, scalars, observer),
    };
    let seconds = began.elapsed().as_secs_f64() - setup;
    Ok(Simulated {
        model,
        history,
        failure,
        setup,
        seconds,
    })
}
