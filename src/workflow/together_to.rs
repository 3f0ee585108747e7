//! Several motions on as fine grids as an accuracy needs.

use std::cell::RefCell;
use std::ops::ControlFlow;

use crate::control::Motions;
use crate::control::problem::Control;
use crate::workflow::accuracy::{Accuracy, AccuracyTarget, Attempt, refine};
use crate::workflow::attempt::FoundTogether;
use crate::workflow::error::WorkflowError;
use crate::workflow::estimate::ErrorSample;
use crate::workflow::grids::{OF_CONTROL, SOLVER, sample, stop};
use crate::workflow::motion::Iterate;
use crate::workflow::optimum::SolveLimits;
use crate::workflow::together::{Solves, Together};

/// Solves for several motions on their own grids, then on those with twice the intervals of each, until every error is estimated below what is
/// wanted; or estimates the error on their own grids. Errors are the greatest of all motions, that of the objective is the one of all.
///
/// # Errors
/// As of [`optimise_together`](crate::workflow::optimise_together).
pub fn optimise_together_to(
    motions: &Motions,
    wanted: AccuracyTarget,
    allowed: SolveLimits,
    observer: &mut dyn FnMut(usize, &Iterate<'_>) -> ControlFlow<()>,
) -> Result<(Together, Accuracy), WorkflowError> {
    let motions = &motions.with_limits_once();
    let solves = RefCell::new(Solves::new(motions, allowed, observer)?);
    let mut refined = refine(
        wanted,
        OF_CONTROL,
        || stop(solves.borrow().left()),
        |times, before: Option<&FoundTogether>| {
            let controls = on_grids(motions, times, wanted);
            let earlier = before.map(|found| {
                let each = found.optima.iter().map(|one| &one.motion);
                each.collect::<Vec<_>>()
            });
            let mut run = match earlier {
                Some(earlier) => solves.borrow_mut().solve(&controls, Some(&earlier)),
                None => solves.borrow_mut().first(&controls),
            }?;
            for (k, old) in before
                .iter()
                .flat_map(|found| found.optima.iter().enumerate())
            {
                run.optima[k].carried = old.carried;
            }
            Ok(attempt(run, &controls))
        },
    )?;
    let solves = solves.into_inner();
    for optimum in &mut refined.run.optima {
        if optimum.meets_equations() && !optimum.is_solved() {
            optimum.stopped = solves.stopped();
        }
    }
    let FoundTogether { optima, whole } = refined.run;
    let together = Together {
        notes: vec![None; optima.len()],
        optima,
        whole,
        iterations: refined.iterations,
    };
    Ok((together, refined.accuracy))
}

/// The problems with a number of times their intervals.
fn on_grids(motions: &Motions, times: usize, wanted: AccuracyTarget) -> Vec<Control> {
    let each = motions.list.iter().map(|motion| {
        let mut control = motion.control.clone();
        control.intervals *= times;
        if let AccuracyTarget::Below(error) = wanted {
            control.solver.tolerance = control.solver.tolerance.min(SOLVER * error);
        }
        control
    });
    each.collect()
}

/// A solve of all motions as one of the grids that are compared.
fn attempt(run: FoundTogether, controls: &[Control]) -> Attempt<FoundTogether> {
    // What is not reproduced may be on a finer grid.
    let is_complete = run.meets_equations();
    let open = run.optima.iter().find(|one| !one.is_solved());
    Attempt {
        sample: match is_complete {
            true => sample_of_all(&run, controls),
            false => ErrorSample::default(),
        },
        intervals: controls.iter().map(|control| control.intervals).sum(),
        iterations: run.optima[0].solution.iterations.len().saturating_sub(1),
        variables: run.whole.variables,
        status: open.unwrap_or(&run.optima[0]).word(),
        is_complete,
        run,
    }
}

/// The values of all motions that are compared, with the objective of all of them.
fn sample_of_all(run: &FoundTogether, controls: &[Control]) -> ErrorSample {
    let each = run.optima.iter().zip(controls);
    let mut each = each.map(|(optimum, control)| ErrorSample {
        objective: None,
        ..sample(optimum, control)
    });
    let first = each.next().unwrap_or_default();
    ErrorSample {
        objective: Some(run.whole.objective),
        further: each.collect(),
        ..first
    }
}
