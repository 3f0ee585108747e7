//! A control problem solved in memory, from its own guess and then from others.

use std::ops::ControlFlow;
use std::time::Instant;

use crate::control::Solution;
use crate::control::problem::Control;
use crate::model::System;
use crate::workflow::attempt::attempt;
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
    let began = Instant::now();
    let first = attempt(system, control, earlier, allowed, observer)?;
    if !is_unreached(&first.solution) {
        return Ok(first);
    }
    let left = SolveLimits {
        seconds: seconds_left(allowed.seconds, began),
        ..allowed
    };
    Ok(second_starts(
        system, control, first, earlier, left, observer,
    ))
}
