//! Refinement of an optimum that its own voltages do not reproduce: it is solved again on finer grids until they do.

use std::ops::ControlFlow;

use crate::control::problem::Control;
use crate::model::System;
use crate::workflow::error::WorkflowError;
use crate::workflow::grids::{GridSolves, VARIABLES};
use crate::workflow::motion::Iterate;
use crate::workflow::optimum::{Optimum, SolveLimits};
use crate::workflow::restarts::is_infeasible;

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

/// Multiple of the intervals that is tried before a problem is called infeasible.
const FINER: usize = 2;

/// The optimum on a finer grid of a problem for which its own grid has none: intervals that do not resolve the motion may leave none.
fn on_finer(
    solves: &mut GridSolves<'_>,
    control: &Control,
    optimum: &Optimum,
) -> Option<RefinedOptimum> {
    let is_tried = is_infeasible(optimum.solution.status)
        && !solves.is_over()
        && FINER * optimum.solution.x.len() <= VARIABLES;
    let intervals = FINER * control.intervals;
    let found = is_tried.then(|| solves.solve(intervals, None))?.ok()?;
    found.is_solved().then(|| RefinedOptimum {
        optimum: found,
        iterations: solves.iterations,
        note: Some(format!(
            "on {} intervals no motion keeps goal and limits; on {intervals} intervals this one does",
            control.intervals
        )),
    })
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
    if let Some(found) = on_finer(&mut solves, control, &optimum) {
        return Ok(found);
    }
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
