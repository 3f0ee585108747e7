//! Refinement of the grid to an accuracy: each grid starts from the solution on the one before, until the estimated error is small enough.

use std::time::Instant;

use serde::Serialize;

use crate::workflow::error::WorkflowError;
use crate::workflow::estimate::{Convergence, ErrorSample, Measures, greatest};

/// Largest ratio of the intervals of a grid to those of the first.
const FINEST: usize = 1 << 10;
/// The finest grid for an estimate, in times the intervals of the first.
const ESTIMATED: usize = 8;
/// No grid has more variables than this.
const VARIABLES: usize = 2_000_000;

/// Target of the error of discretisation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum AccuracyTarget {
    /// Grids are refined until every error is estimated below this.
    Below(f64),
    /// The error on the grid of the problem is estimated, by two refinements or more.
    Estimate,
}

/// A run on one grid.
#[derive(Clone, Debug)]
pub struct Attempt<R> {
    /// The run.
    pub run: R,
    /// Values that are compared.
    pub sample: ErrorSample,
    /// Number of intervals or steps.
    pub intervals: usize,
    /// Iterations of the solver.
    pub iterations: usize,
    /// Unknowns of all instants.
    pub variables: usize,
    /// Status at its end, in a word.
    pub status: &'static str,
    /// True if it came to its end.
    pub is_complete: bool,
}

/// Error of discretisation, as written to `summary.json`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Accuracy {
    /// The error that was asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub requested: Option<f64>,
    /// True if the estimate is below it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub is_met: Option<bool>,
    /// Estimated errors of the solution that is kept; none where there is no second grid.
    pub estimate: Measures,
    /// True if differences that fall over three grids confirm the estimate.
    pub is_confirmed: bool,
    /// Orders in the step that the last three grids show, as observed; zero or less where differences do not fall.
    pub order: Measures,
    /// Order where none is shown.
    pub assumed_order: f64,
    /// The grids, coarsest first.
    pub levels: Vec<GridLevel>,
    /// Reason why there is no finer grid, where the accuracy is not met or no estimate could be made.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub stopped: Option<String>,
}

/// A grid.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct GridLevel {
    /// Number of intervals or steps.
    pub intervals: usize,
    /// Status at its end.
    pub status: &'static str,
    /// Seconds, set-up and comparison included.
    pub seconds: f64,
    /// Iterations of the solver, or of Newton's method.
    pub iterations: usize,
    /// The objective; a simulation has none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub objective: Option<f64>,
    /// Estimated errors, from the grids so far.
    #[serde(skip_serializing_if = "Measures::is_empty")]
    pub estimate: Measures,
}

/// The run that is kept and the way to it.
#[derive(Clone, Debug)]
pub struct Refined<R> {
    /// The run on the finest grid that was solved; the one on the first grid where only its error was asked for.
    pub run: R,
    /// Factor by which its intervals exceed those of the first grid.
    pub times: usize,
    /// Iterations on the grids up to its own.
    pub iterations: usize,
    /// Error of discretisation, as reported.
    pub accuracy: Accuracy,
}

/// Runs on finer and finer grids.
///
/// `attempt` runs on a number of times the intervals of the first grid, from the run before; `stop` says in a word why no
/// other grid may follow. The order of convergence is `assumed` until three grids show it.
///
/// # Errors
/// The first run has no answer. A later one that has none ends the refinement.
pub fn refine<R>(
    wanted: AccuracyTarget,
    assumed: f64,
    stop: impl Fn() -> Option<&'static str>,
    mut attempt: impl FnMut(usize, Option<&R>) -> Result<Attempt<R>, WorkflowError>,
) -> Result<Refined<R>, WorkflowError> {
    let mut levels = Vec::new();
    let mut timed = |times: usize, before: Option<&R>| {
        let began = Instant::now();
        attempt(times, before).map(|attempt| (attempt, began.elapsed().as_secs_f64()))
    };
    let (mut kept, seconds) = timed(1, None)?;
    levels.push(GridLevel::new(&kept, seconds));
    let mut times = 1;
    let mut iterations = kept.iterations;
    let mut convergence = Convergence::default();
    convergence.add(None, &kept.sample);
    let mut estimate = Measures::new();
    let mut is_confirmed = false;
    // The run on the first grid, where its error alone was asked for.
    let mut own: Option<Attempt<R>> = None;
    let mut stopped = None;
    if !kept.is_complete {
        stopped = Some(kept.status.to_owned());
    }
    while stopped.is_none() {
        let finer = 2 * times;
        stopped = match stop() {
            Some(word) => Some(word.to_owned()),
            None if finer > FINEST || 2 * kept.variables > VARIABLES => {
                Some("too_large".to_owned())
            }
            None => None,
        };
        if stopped.is_some() {
            break;
        }
        let (fine, seconds) = match timed(finer, Some(&kept.run)) {
            Ok(found) => found,
            Err(error) => {
                stopped = Some(error.to_string());
                break;
            }
        };
        let mut level = GridLevel::new(&fine, seconds);
        if !fine.is_complete {
            stopped = Some(fine.status.to_owned());
            levels.push(level);
            break;
        }
        convergence.add(Some(&kept.sample), &fine.sample);
        is_confirmed = convergence.is_confirmed();
        estimate = convergence.errors(assumed);
        let AccuracyTarget::Below(requested) = wanted else {
            // The first grid is as far from the finest one, and that from the limit.
            let first = own.as_ref().unwrap_or(&kept);
            estimate = first.sample.errors_from(&fine.sample, &estimate);
            levels[0].estimate.clone_from(&estimate);
            levels.push(level);
            let is_last = is_confirmed || finer >= ESTIMATED;
            own.get_or_insert(std::mem::replace(&mut kept, fine));
            times = finer;
            if is_last {
                break;
            }
            continue;
        };
        level.estimate.clone_from(&estimate);
        levels.push(level);
        iterations += fine.iterations;
        (kept, times) = (fine, finer);
        if is_below(&estimate, requested) && is_confirmed {
            break;
        }
    }
    if let Some(own) = own {
        (kept, times) = (own, 1);
    }
    let requested = match wanted {
        AccuracyTarget::Below(value) => Some(value),
        AccuracyTarget::Estimate => None,
    };
    Ok(Refined {
        run: kept.run,
        times,
        iterations,
        accuracy: Accuracy {
            requested,
            is_met: requested.map(|value| is_confirmed && is_below(&estimate, value)),
            is_confirmed,
            order: convergence.orders(),
            assumed_order: assumed,
            estimate,
            levels,
            stopped,
        },
    })
}

/// Returns true if there is an estimate, all of it below a value.
fn is_below(estimate: &Measures, value: f64) -> bool {
    greatest(estimate).is_some_and(|(_, error)| error <= value)
}

impl GridLevel {
    fn new<R>(attempt: &Attempt<R>, seconds: f64) -> Self {
        Self {
            intervals: attempt.intervals,
            status: attempt.status,
            seconds,
            iterations: attempt.iterations,
            objective: attempt.sample.objective,
            estimate: Measures::new(),
        }
    }
}
