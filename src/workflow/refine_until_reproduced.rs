//! Refinement of an optimum that its own voltages do not reproduce: it is solved again on finer grids until they do.

use std::ops::ControlFlow;

use crate::control::problem::Control;
use crate::model::System;
use crate::workflow::error::WorkflowError;
use crate::workflow::grid_solves::{GridSolves, VARIABLES};
use crate::workflow::iterate::Iterate;
use crate::workflow::optimum::{Optimum, SolveLimits};

/// Multiples of the intervals of the problem that are tried.
const TIMES: [usize; 3] = [2, 4, 8];

/// An optimum and the way to it.
#[derive(Debug)]
pub struct RefinedOptimum {
    /// The one of the problem's own grid, or the first one on a finer grid that is reproduced.
    pub optimum: Optimum,
    /// Iterations on all grids.
    pub iterations: usize,
    /// Note on the reason for another grid, or on the lack of an optimum that is reproduced.
    pub note: Option<String>,
}

/// Solves a control problem on its own grid; where the optimum is not reproduced, on finer ones, each from the optimum
/// before, then from the guess of the problem.
///
/// # Errors
/// As of [`optimise`](crate::workflow::optimise::optimise).
pub(crate) fn reproduced(
    system: &System,
    control: &Control,
    allowed: SolveLimits,
    observer: &mut dyn FnMut(usize, &Iterate<'_>) -> ControlFlow<()>,
) -> Result<RefinedOptimum, WorkflowError> {
    let mut solves = GridSolves::new(system, control, allowed, observer);
    let mut optimum = solves.solve(control.intervals, None)?;
    let Some(cause) = optimum.cause() else {
        return Ok(RefinedOptimum {
            optimum,
            iterations: solves.iterations,
            note: None,
        });
    };
    let of_problem = format!("on {} intervals: {}", control.intervals, cause.message());
    let mut before = None;
    let mut finest = None;
    'grids: for times in TIMES {
        let intervals = control.intervals * times;
        for from_before in [true, false] {
            if solves.is_over() || times * optimum.solution.x.len() > VARIABLES {
                break 'grids;
            }
            let earlier = from_before.then(|| before.as_ref().unwrap_or(&optimum));
            let Ok(mut found) = solves.solve(intervals, earlier) else {
                break 'grids;
            };
            finest = Some(intervals);
            if found.is_solved() {
                found.carried = optimum.carried;
                return Ok(RefinedOptimum {
                    optimum: found,
                    iterations: solves.iterations,
                    note: Some(format!(
                        "{of_problem}; solved again on {intervals} intervals; this optimum is reproduced by its inputs"
                    )),
                });
            }
            if found.solution.status.is_solved() {
                before = Some(found);
            }
        }
    }
    optimum.stopped = solves.stopped();
    let note = finest.map(|n| {
        format!(
            "on finer grids of up to {n} intervals no optimum was reproduced by its inputs either"
        )
    });
    Ok(RefinedOptimum {
        optimum,
        iterations: solves.iterations,
        note,
    })
}
