//! The motion of a system under constant voltages, and its drift after the end of an optimum.

use std::ops::ControlFlow;

use crate::control::Solution;
use crate::dynamics::{DiscreteTrajectory, Start, StepError, simulate};
use crate::model::Model;
use crate::workflow::distance::Distance;
use crate::workflow::motion::solved;
use crate::workflow::repeat::go_on;

/// Durations of the optimum for which voltages are held.
pub(crate) const DURATIONS: usize = 5;
/// A drift from the goal, as a part of the path length, from which on it is not held.
const DRIFTS: f64 = 0.05;

/// The motion after an optimum.
pub(crate) struct Held {
    /// The motion, which begins at the end of the optimum.
    pub(crate) motion: Solution,
    /// Greatest drift from the last optimal instant.
    pub(crate) drift: Distance,
    /// The error with which the simulation ended early.
    pub(crate) failure: Option<StepError>,
}

/// Simulates the voltages of an instant, from the end of an optimum on.
pub(crate) fn held(model: &Model, end: &Start, optimal: &Solution, voltages: &[f64]) -> Held {
    let (discrete, failure) = constant(model, end, optimal, voltages, DURATIONS, go_on);
    let motion = solved(model, &discrete, None);
    let n = optimal.intervals();
    let of = |k: usize| Distance::between(model, &motion, k, optimal, n);
    let drift = (0..motion.times.len()).map(of);
    Held {
        drift: drift.fold(Distance::default(), Distance::max),
        motion,
        failure,
    }
}

/// Simulates constant voltages with the mean step of an optimum, for a number of its durations.
pub(crate) fn constant(
    model: &Model,
    start: &Start,
    optimal: &Solution,
    voltages: &[f64],
    durations: usize,
    go_on: impl Fn() -> ControlFlow<()>,
) -> (DiscreteTrajectory, Option<StepError>) {
    let scalars = model.scalars(voltages);
    let n = optimal.intervals();
    let h = optimal.times[n] / n as f64;
    let constant = |_: f64, _: f64| scalars.clone();
    simulate(model, start, h, durations * n, constant, |_| go_on())
}

/// Returns true if a drift compared with a path is so small that the end counts as held.
pub(crate) fn is_small(drift: Distance, path_length: Distance, model: &Model) -> bool {
    drift.over(path_length, model) <= DRIFTS
}
