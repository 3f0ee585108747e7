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
pub(super) const VARIABLES: usize = 2_000_000;
/// Order of optimal voltages until three grids show it: switches and the cost of the first and last jump may make it one.
pub(super) const OF_CONTROL: f64 = 1.0;

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
    let mut timed = |times: usize, before: Option<&R>| {
        let began = Instant::now();
        attempt(times, before).map(|attempt| (attempt, began.elapsed().as_secs_f64()))
    };
    let mut grids = Grids::new(timed(1, None)?, assumed);
    while grids.stopped.is_none() {
        let finer = 2 * grids.times;
        grids.stopped = stop().map(str::to_owned).or_else(|| grids.limit(finer));
        if grids.stopped.is_some() {
            break;
        }
        match timed(finer, Some(&grids.kept.run)) {
            Err(error) => grids.stopped = Some(error.to_string()),
            Ok((fine, seconds)) if !fine.is_complete => {
                grids.stopped = Some(fine.status.to_owned());
                grids.levels.push(GridLevel::new(&fine, seconds));
            }
            Ok(fine) => {
                let is_last = match wanted {
                    AccuracyTarget::Below(requested) => grids.replace(fine, requested),
                    AccuracyTarget::Estimate => grids.compare(fine),
                };
                if is_last {
                    break;
                }
            }
        }
    }
    Ok(grids.finish(wanted))
}

/// The grids of a refinement so far.
struct Grids<R> {
    /// The run on the finest grid, and the factor by which its intervals exceed those of the first.
    kept: Attempt<R>,
    times: usize,
    /// The run on the first grid, where its error alone was asked for.
    own: Option<Attempt<R>>,
    /// Iterations on the grids up to the one that is kept.
    iterations: usize,
    levels: Vec<GridLevel>,
    convergence: Convergence,
    assumed: f64,
    estimate: Measures,
    is_confirmed: bool,
    /// Reason why there is no finer grid.
    stopped: Option<String>,
}

impl<R> Grids<R> {
    /// The first grid, with its seconds.
    fn new((first, seconds): (Attempt<R>, f64), assumed: f64) -> Self {
        let mut convergence = Convergence::default();
        convergence.add(None, &first.sample);
        Self {
            times: 1,
            own: None,
            iterations: first.iterations,
            levels: vec![GridLevel::new(&first, seconds)],
            convergence,
            assumed,
            estimate: Measures::new(),
            is_confirmed: false,
            stopped: (!first.is_complete).then(|| first.status.to_owned()),
            kept: first,
        }
    }

    /// The word for a next grid that would be too fine.
    fn limit(&self, finer: usize) -> Option<String> {
        let is_too_large = finer > FINEST || 2 * self.kept.variables > VARIABLES;
        is_too_large.then(|| "too_large".to_owned())
    }

    /// Estimates the errors of a finer grid.
    fn estimate(&mut self, fine: &Attempt<R>) {
        self.convergence.add(Some(&self.kept.sample), &fine.sample);
        self.is_confirmed = self.convergence.is_confirmed();
        self.estimate = self.convergence.errors(self.assumed);
    }

    /// Estimates the error of the first grid by a finer one. Returns true if that was the last grid.
    fn compare(&mut self, (fine, seconds): (Attempt<R>, f64)) -> bool {
        self.estimate(&fine);
        // The first grid is as far from the finest one, and that from the limit.
        let first = self.own.as_ref().unwrap_or(&self.kept);
        self.estimate = first.sample.errors_from(&fine.sample, &self.estimate);
        self.levels[0].estimate.clone_from(&self.estimate);
        self.levels.push(GridLevel::new(&fine, seconds));
        self.times *= 2;
        let coarse = std::mem::replace(&mut self.kept, fine);
        self.own.get_or_insert(coarse);
        self.is_confirmed || self.times >= ESTIMATED
    }

    /// Keeps a finer grid in place of the one before. Returns true if its error is below the one requested.
    fn replace(&mut self, (fine, seconds): (Attempt<R>, f64), requested: f64) -> bool {
        self.estimate(&fine);
        let mut level = GridLevel::new(&fine, seconds);
        level.estimate.clone_from(&self.estimate);
        self.levels.push(level);
        self.iterations += fine.iterations;
        self.times *= 2;
        self.kept = fine;
        is_below(&self.estimate, requested) && self.is_confirmed
    }

    /// The run that is kept, with the error of its grid.
    fn finish(self, wanted: AccuracyTarget) -> Refined<R> {
        let (kept, times) = match self.own {
            Some(own) => (own, 1),
            None => (self.kept, self.times),
        };
        let requested = match wanted {
            AccuracyTarget::Below(value) => Some(value),
            AccuracyTarget::Estimate => None,
        };
        let is_below = |value| self.is_confirmed && is_below(&self.estimate, value);
        Refined {
            run: kept.run,
            times,
            iterations: self.iterations,
            accuracy: Accuracy {
                requested,
                is_met: requested.map(is_below),
                is_confirmed: self.is_confirmed,
                order: self.convergence.orders(),
                assumed_order: self.assumed,
                estimate: self.estimate,
                levels: self.levels,
                stopped: self.stopped,
            },
        }
    }
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
