//! A task solved in memory, from its own guess and then from others.

use std::ops::ControlFlow;
use std::time::Instant;

use crate::control::Solution;
use crate::control::problem::{Control, ControlTask, MotionTask};
use crate::model::System;
use crate::workflow::attempt::{FoundTogether, attempt};
use crate::workflow::error::WorkflowError;
use crate::workflow::motion::Iterate;
use crate::workflow::optimum::{Optimum, SolveLimits, seconds_left};
use crate::workflow::restarts::is_unreached;
use crate::workflow::retry_displaced::second_starts;

/// Solves a control problem, from an `earlier` solution where one is given; from its guess, and from others where that leads nowhere;
/// `observer` sees every iterate.
///
/// # Errors
/// Start, goal, guess or an option of the solver is wrong. A problem without a solution is no error: see the status.
pub fn optimise(
    system: &System,
    control: &Control,
    earlier: Option<&Solution>,
    allowed: SolveLimits,
    observer: &mut dyn FnMut(&Iterate<'_>) -> ControlFlow<()>,
) -> Result<Optimum, WorkflowError> {
    let motion = MotionTask {
        earlier,
        ..MotionTask::alone(system, control)
    };
    let mut found = optimise_task(&motion.into(), allowed, observer)?;
    Ok(found.optima.remove(0))
}

/// Solves a task; a single motion from other starts too, where its own one leads nowhere.
pub(super) fn optimise_task(
    task: &ControlTask<'_>,
    allowed: SolveLimits,
    observer: &mut dyn FnMut(&Iterate<'_>) -> ControlFlow<()>,
) -> Result<FoundTogether, WorkflowError> {
    let began = Instant::now();
    let mut found = attempt(task, allowed, observer)?;
    if let [motion] = task.motions[..]
        && is_unreached(&found.optima[0].solution)
    {
        let left = SolveLimits {
            seconds: seconds_left(allowed.seconds, began),
            ..allowed
        };
        let first = found.optima.remove(0);
        let second = second_starts(motion, first, left, observer);
        found.optima.push(second);
    }
    Ok(found)
}
