//! An iterate as an observer sees it, and the data of the one before.

use crate::ipopt::solution::{Evaluations, Iteration, Seconds};
use crate::nlp::{Bounds, Multipliers, Status};

/// An accepted iterate.
#[derive(Debug)]
pub struct Reached<'a> {
    /// Its variables.
    pub x: &'a [f64],
    /// The iterate before, where its multipliers are known: Ipopt gives those of an iterate on the way to the next one, and none in the
    /// restoration phase.
    pub before: Option<Before<'a>>,
}

/// The iterate before, with its multipliers.
#[derive(Debug)]
pub struct Before<'a> {
    /// Report of Ipopt on it.
    pub report: &'a Iteration,
    /// Its variables.
    pub x: &'a [f64],
    /// Its multipliers; those of bounds are the barrier parameter over the distance, to which Ipopt keeps them near.
    pub multipliers: &'a Multipliers,
}

/// Distance from a relaxed bound that is distinguished from zero, of its magnitude and at least of one.
const CLOSEST: f64 = 1e-14;
/// Records of iterations for which room is made beforehand.
const RESERVED_ITERATIONS: usize = 4096;

/// Record of a solve in addition to the answer of Ipopt.
#[derive(Debug, Default)]
pub(super) struct Record {
    /// Relaxation of bounds, relative to their magnitude and at least to one.
    pub(super) relaxed: f64,
    /// One record per iteration.
    pub(super) iterations: Vec<Iteration>,
    /// Point at which derivatives were evaluated last.
    pub(super) derivatives_at: Vec<f64>,
    /// The latest iterate reported; before the first one, the starting point.
    pub(super) latest: Vec<f64>,
    /// Room for an iterate and the one before, where they are shown as other points than Ipopt has them, and for the multipliers of that one.
    pub(super) shown: ([Vec<f64>; 2], Multipliers),
    /// Multipliers of the constraints there, as the Hessian was asked with; empty until it was.
    pub(super) costates: Vec<f64>,
    /// Reason why the solve was stopped from outside, if it was.
    pub(super) stopped: Option<Status>,
    /// Seconds of each part; `total` and `solver` are filled in at the end.
    pub(super) seconds: Seconds,
    /// Number of evaluations of each quantity.
    pub(super) evaluations: Evaluations,
    /// Number of evaluations that met NaN or ±∞.
    pub(super) failed: usize,
}

impl Record {
    /// Nothing is known yet but the start.
    pub(super) fn begin(&mut self, start: &[f64]) {
        self.iterations.clear();
        self.iterations.reserve(RESERVED_ITERATIONS);
        for place in [&mut self.derivatives_at, &mut self.latest] {
            place.clear();
            place.extend_from_slice(start);
        }
        self.costates.clear();
        self.stopped = None;
        self.seconds = Seconds::default();
        self.evaluations = Evaluations::default();
        self.failed = 0;
    }

    /// Multipliers of the latest iterate, where they are known: Ipopt has lost them where it was stopped on the way to the next one. Those of
    /// bounds are the barrier parameter over the distance, to which Ipopt keeps them near.
    pub(super) fn write_multipliers(&self, bounds: &Bounds, to: &mut Multipliers) {
        let (Some(last), false) = (self.iterations.last(), self.costates.is_empty()) else {
            return;
        };
        to.constraints.copy_from_slice(&self.costates);
        for (i, x) in self.latest.iter().enumerate() {
            let (lower, upper) = (bounds.lower[i], bounds.upper[i]);
            let of_bound = |gap: f64, bound: f64| match lower == upper {
                true => 0.0,
                false => {
                    let size = bound.abs().max(1.0);
                    last.mu / (gap + self.relaxed * size).max(CLOSEST * size)
                }
            };
            to.lower[i] = of_bound(x - lower, lower);
            to.upper[i] = of_bound(upper - x, upper);
        }
    }
}
