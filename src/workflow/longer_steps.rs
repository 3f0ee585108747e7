//! Error of a motion in equal steps by a method of high order, from the same motion in steps two and four times as long.
//!
//! Divided differences of many instants say little of motions with vibrations or with corners that few steps resolve: the error told was
//! hundreds of times too small. With d the distance between the motion and that in steps of twice the length, and d₂ that between the latter
//! and the motion in steps of four times the length, the error is d/(d₂/d − 1) where d₂/d, which is 2ᵖ for short steps, is at least half of
//! that; otherwise the steps do not resolve the motion, and all of d is told.

use crate::control::problem::Simulation;
use crate::dynamics::trajectory::Trajectory;
use crate::dynamics::{LocalError, distance_between};
use crate::workflow::integrate::{Driven, Simulated};
use crate::workflow::tolerance::repeated;

/// Orders up to this are estimated from the motion itself.
const LOW: usize = 2;
/// Part of the ratio of short steps that shows their order, and the fewest steps of the coarsest motion in which it does.
const FALLS: f64 = 0.5;
const FEWEST: usize = 6;

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
    if local.order <= LOW || task.tolerance.is_some() || !is_whole || !moves {
        return local;
    }
    let found = error(simulated, task, trajectory, local.order);
    let (error, is_resolved) = found.unwrap_or((local.error, false));
    LocalError {
        error: error.max(local.error),
        is_resolved,
        ..local
    }
}

/// The error in mm, and whether longer steps show the order; none where they fail.
fn error(
    simulated: &Simulated,
    task: &Simulation,
    trajectory: &Trajectory,
    order: usize,
) -> Option<(f64, bool)> {
    let (model, discrete) = (&simulated.model, &simulated.discrete);
    let [pairs, fours] = [2, 4].map(|count| every(count, discrete.intervals()));
    let drive = Driven {
        model,
        voltages: &task.voltages,
    };
    let by = |instants: &[usize]| {
        let times: Vec<f64> = instants.iter().map(|&k| discrete.times[k]).collect();
        repeated(task.solving, model, &drive, discrete, &times)
    };
    let (twice, four_times) = (by(&pairs)?, by(&fours)?);
    let [of_twice, of_four] =
        [&twice, &four_times].map(|motion| Trajectory::from_discrete(model, motion));
    let among: Vec<usize> = fours
        .iter()
        .filter_map(|k| pairs.binary_search(k).ok())
        .collect();
    let last = distance_between(model, (discrete, trajectory), &pairs, (&twice, &of_twice));
    let before = distance_between(model, (&twice, &of_twice), &among, (&four_times, &of_four));
    let of_order = 2.0_f64.powi(i32::try_from(order).ok()?);
    let is_resolved = fours.len() > FEWEST && before >= FALLS * of_order * last;
    let left = match is_resolved {
        true => f64::min(before / last, of_order) - 1.0,
        false => 1.0,
    };
    Some((if last > 0.0 { last / left } else { 0.0 }, is_resolved))
}

/// Every so many of the instants of a number of steps, and the last one.
fn every(count: usize, steps: usize) -> Vec<usize> {
    let mut instants: Vec<usize> = (0..steps).step_by(count).collect();
    instants.push(steps);
    instants
}
