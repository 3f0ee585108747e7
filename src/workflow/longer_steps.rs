//! Error of a motion, from the same motion in steps of other lengths.
//!
//! Divided differences of many instants say little of motions with vibrations or with corners that few steps resolve: the error told was
//! hundreds of times too small. In steps by a tolerance it is the error that confirmed the tolerance. For a method of high order in equal
//! steps, with d the distance between the motion and that in steps of half the length, and d₂ that between the motion and that in steps
//! of twice the length, the error is d/(1 − d/d₂): d₂/d, which is 2ᵖ for short steps, counts as 2 at least. Where it is not half of 2ᵖ, the steps do
//! not resolve the motion.

use crate::control::problem::Simulation;
use crate::dynamics::trajectory::Trajectory;
use crate::dynamics::{LocalError, distance_between};
use crate::workflow::integrate::{Driven, Simulated};
use crate::workflow::tolerance::{halved, repeated};

/// Orders up to this are estimated from the motion itself.
const LOW: usize = 2;
/// Part of the ratio of short steps that shows their order, and the fewest steps of the coarsest motion in which it does.
const FALLS: f64 = 0.5;
const FEWEST: usize = 6;
/// Least ratio of two distances.
const LEAST: f64 = 2.0;

/// The error of a motion with its `trajectory`, for which the sum of its local errors was estimated.
pub(crate) fn confirmed(
    simulated: &Simulated,
    task: &Simulation,
    trajectory: &Trajectory,
    local: LocalError,
) -> LocalError {
    let is_whole = simulated.failure.is_none();
    // What rests has no error.
    let moves = local.error > 0.0;
    if let Some(known) = simulated.error.filter(|_| moves) {
        return LocalError {
            error: known.place,
            is_resolved: known.is_confirmed,
            ..local
        };
    }
    if local.order <= LOW || task.tolerance.is_some() || !is_whole || !moves {
        return local;
    }
    let found = error(simulated, task, trajectory, local.order);
    let (error, is_resolved) = found.unwrap_or((local.error, false));
    LocalError {
        error,
        is_resolved,
        ..local
    }
}

/// The error in mm, and whether other steps show the order; none where they fail.
fn error(
    simulated: &Simulated,
    task: &Simulation,
    trajectory: &Trajectory,
    order: usize,
) -> Option<(f64, bool)> {
    let (model, discrete) = (&simulated.model, &simulated.discrete);
    let drive = Driven {
        model,
        voltages: &task.voltages,
    };
    let by = |times: &[f64]| repeated(task.solving, model, &drive, discrete, times);
    let halves = by(&halved(&discrete.times))?;
    let of_halves = Trajectory::from_discrete(model, &halves);
    let among = every(2, halves.intervals());
    let last = distance_between(model, (&halves, &of_halves), &among, (discrete, trajectory));
    let pairs = every(2, discrete.intervals());
    let times: Vec<f64> = pairs.iter().map(|&k| discrete.times[k]).collect();
    let before = by(&times).map_or(f64::NAN, |twice| {
        let of_twice = Trajectory::from_discrete(model, &twice);
        distance_between(model, (discrete, trajectory), &pairs, (&twice, &of_twice))
    });
    let of_order = 2.0_f64.powi(i32::try_from(order).ok()?);
    let ratio = (before / last).clamp(LEAST, of_order);
    let ratio = if ratio.is_nan() { LEAST } else { ratio };
    let is_resolved = discrete.intervals() >= 2 * FEWEST && before >= FALLS * of_order * last;
    Some((last / (1.0 - 1.0 / ratio), is_resolved))
}

/// Every so many of the instants of a number of steps, and the last one.
fn every(count: usize, steps: usize) -> Vec<usize> {
    let mut instants: Vec<usize> = (0..steps).step_by(count).collect();
    instants.push(steps);
    instants
}
