//! Refinement of a control problem until the verification of its optimum confirms an accuracy.
//!
//! The error of a grid falls with the square of its step: from the error e that a verification confirms on N intervals the next grid has
//! about N √(e/ε), and begins at the optimum before.

use std::ops::ControlFlow;

use crate::control::problem::Control;
use crate::model::System;
use crate::workflow::error::WorkflowError;
use crate::workflow::grids::{GridSolves, VARIABLES};
use crate::workflow::motion::Iterate;
use crate::workflow::optimum::{Optimum, SolveLimits};
use crate::workflow::refine_until_reproduced::RefinedOptimum;

/// Deviation of the motion under the optimal voltages that is confirmed where no accuracy is set, as a part of the path length.
pub const ACCURACY: f64 = 0.01;
/// The part of the accuracy that the next grid is made for.
const AIMED: f64 = 0.7;
/// Least and greatest factor between the intervals of two grids, and that where the error is not known.
const FACTORS: [f64; 2] = [1.25, 4.0];
const UNKNOWN: f64 = 2.0;
/// Limit of grids.
pub(super) const GRIDS: usize = 7;

/// Solves a control problem on its first grid, then on finer ones, until the verification confirms that the motion under the optimal voltages
/// deviates from the optimum by no more than a part `accuracy` of the path length.
///
/// # Errors
/// As of [`optimise`](crate::workflow::optimise::optimise).
pub fn verified(
    system: &System,
    control: &Control,
    accuracy: f64,
    allowed: SolveLimits,
    observer: &mut dyn FnMut(usize, &Iterate<'_>) -> ControlFlow<()>,
) -> Result<RefinedOptimum, WorkflowError> {
    let mut solves = GridSolves::new(system, control, allowed, observer);
    let mut best = solves.solve(control.intervals, None)?;
    let mut why = None;
    for _ in 1..GRIDS {
        if !best.meets_equations() || is_confirmed(&best, accuracy) {
            break;
        }
        let n = best.motion.intervals();
        let next = (n as f64 * factor(&best, accuracy)).ceil();
        let variables = best.solution.x.len() as f64 * next / n as f64;
        let is_over = solves.is_over();
        if is_over || variables > VARIABLES as f64 {
            why = Some(if is_over {
                "it was stopped"
            } else {
                "a finer grid is too large"
            });
            break;
        }
        let mut found = solves.solve(next as usize, Some(&best)).ok();
        let is_found =
            |found: &Option<Optimum>| found.as_ref().is_some_and(Optimum::meets_equations);
        if !is_found(&found) && !solves.is_over() {
            found = solves.solve(next as usize, None).ok();
        }
        let Some(mut found) = found.filter(Optimum::meets_equations) else {
            why = Some(match solves.is_over() {
                true => "it was stopped",
                false => "a finer grid was not solved",
            });
            break;
        };
        found.carried = best.carried;
        best = found;
    }
    if !best.is_solved() && best.meets_equations() {
        best.stopped = solves.stopped();
    }
    let is_short = best.meets_equations() && !is_confirmed(&best, accuracy);
    let note = is_short.then(|| unconfirmed(&best, accuracy, why));
    Ok(RefinedOptimum {
        optimum: best,
        iterations: solves.iterations,
        note,
    })
}

/// That the accuracy is not confirmed, and why no finer grid was tried.
pub(super) fn unconfirmed(optimum: &Optimum, accuracy: f64, why: Option<&str>) -> String {
    format!(
        "the verification does not confirm an error below {} % of the path length on {} intervals{}",
        100.0 * accuracy,
        optimum.motion.intervals(),
        why.map_or(String::new(), |why| format!(": {why}")),
    )
}

/// Returns true if the verification confirms an error of no more than this part of the path length.
pub(super) fn is_confirmed(optimum: &Optimum, accuracy: f64) -> bool {
    let tested = optimum.resimulation.as_ref();
    tested.is_some_and(|tested| {
        let error = tested.error.unwrap_or(f64::INFINITY);
        tested.cause.is_none() && tested.is_confirmed && error <= accuracy
    })
}

/// Returns the factor of the intervals of the next grid.
pub(super) fn factor(optimum: &Optimum, accuracy: f64) -> f64 {
    let tested = optimum
        .resimulation
        .as_ref()
        .filter(|tested| tested.is_confirmed);
    match tested.and_then(|tested| tested.error) {
        Some(error) => (error / (AIMED * accuracy))
            .sqrt()
            .clamp(FACTORS[0], FACTORS[1]),
        None => UNKNOWN,
    }
}
