//! A simulation in memory.

use std::ops::ControlFlow;
use std::time::Instant;

use crate::control::problem::{BoundaryState, Simulation};
use crate::control::resolve_start;
use crate::dynamics::{
    DiscreteTrajectory, Lengths, StepControl, StepError, StepState, TimeGrid, go_on,
};
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
    observer: impl FnMut(&Model, &DiscreteTrajectory) -> ControlFlow<()>,
) -> Result<Simulated, WorkflowError> {
    integrate_on(system, task, None, observer)
}

/// The same, from where a motion that has `begun` ends: the whole is to the bit what it would be without a stop.
///
/// # Errors
/// As of [`integrate`]; a motion of another model or method is a failure.
pub fn integrate_on(
    system: &System,
    task: &Simulation,
    begun: Option<DiscreteTrajectory>,
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
    let of = StepState::of(&model, task.solving);
    let mut begun = match begun {
        Some(begun) => begun,
        None => {
            let start = resolve_start(&model, &task.start, "start").map_err(wrong)?;
            let mut begun = DiscreteTrajectory::at(&start);
            if let BoundaryState::EndOf(end) = &task.start
                && end.method.of == of
            {
                begun.end = end.method.clone();
            }
            begun
        }
    };
    begun.end.of = of;
    let setup = began.elapsed().as_secs_f64();
    phase("ordering and first factorisation");
    let observer = |history: &DiscreteTrajectory| observer(&model, history);
    let scalars = |from: f64, to: f64| model.scalars(&task.voltages.at(0.5 * (from + to)));
    let switches = task.voltages.switches();
    let lengths = match task.tolerance {
        Some(tolerance) => Lengths::Controlled(StepControl {
            duration: task.duration,
            first: h,
            tolerance,
            switches: &switches,
        }),
        None => Lengths::Equal(TimeGrid { h, steps }),
    };
    let (history, failure) = go_on(task.solving, &model, begun, lengths, scalars, observer);
    let seconds = began.elapsed().as_secs_f64() - setup;
    Ok(Simulated {
        model,
        history,
        failure,
        setup,
        seconds,
    })
}
