//! Inputs at an instant: the limits from the intervals on both of its sides, with weights of which the sum is 1.
//!
//! A quantity of the table is the mean of its values on both sides, each weighted by the length of the other interval. Where the inputs are
//! continuous both are equal; where they switch it is a mean of both; where they are constant over intervals it is of second order.

use crate::dynamics::discrete_trajectory::{DiscreteTrajectory, Reading};
use crate::model::Model;

/// One side of an instant.
#[derive(Debug)]
pub(super) struct Side {
    /// Voltages, loads and potentials.
    pub(super) scalars: Vec<f64>,
    /// Rates per ms of the inputs among them; zero of all others.
    pub(super) rates: Vec<f64>,
    /// Its weight.
    pub(super) weight: f64,
}

/// The sides of instant k: the one before it and the one after it, where there are such intervals.
pub(super) fn sides(model: &Model, discrete: &DiscreteTrajectory, k: usize) -> Vec<Side> {
    let none = || vec![0.0; model.action.intervals.scalars];
    let count = discrete.intervals();
    if count == 0 {
        let (scalars, rates, weight) = (none(), none(), 1.0);
        return vec![Side {
            scalars,
            rates,
            weight,
        }];
    }
    let inputs = model.variables.inputs();
    let length = |interval: usize| discrete.times[interval + 1] - discrete.times[interval];
    let side = |interval: usize, end: usize, weight: f64| {
        let mut scalars = discrete.scalars[interval].clone();
        let mut rates = none();
        if let Some(ends) = discrete.ends.get(interval) {
            scalars[inputs.clone()].copy_from_slice(&ends[end].values);
            rates[inputs.clone()].copy_from_slice(&ends[end].rates);
        }
        Side {
            scalars,
            rates,
            weight,
        }
    };
    if discrete.reading == Reading::States {
        return vec![side(k.max(1) - 1, 1, 1.0)];
    }
    if k > 0 && k < count {
        let [before, after] = [length(k - 1), length(k)];
        let part = after / (before + after);
        return vec![side(k - 1, 1, part), side(k, 0, 1.0 - part)];
    }
    let mut only = match k {
        0 => side(0, 0, 1.0),
        _ => side(k - 1, 1, 1.0),
    };
    extrapolate(model, discrete, k, &mut only);
    vec![only]
}

/// Extrapolates the potentials, which are known within intervals, to the first or the last instant k, unless the inputs switch before the next
/// instant.
fn extrapolate(model: &Model, discrete: &DiscreteTrajectory, k: usize, side: &mut Side) {
    let potentials = model.variables.algebraic();
    let count = discrete.intervals();
    let is_known = k > 0 && discrete.reading == Reading::Instants;
    if potentials.is_empty()
        || count < 2
        || is_known
        || jump(model, discrete, k.clamp(1, count - 1))
    {
        return;
    }
    let at = |interval: usize| match discrete.reading {
        Reading::Intervals => 0.5 * (discrete.times[interval] + discrete.times[interval + 1]),
        Reading::Instants | Reading::States => discrete.times[interval + 1],
    };
    let [near, far] = if k == 0 {
        [0, 1]
    } else {
        [count - 1, count - 2]
    };
    let part = (discrete.times[k] - at(near)) / (at(near) - at(far));
    for i in potentials {
        let [near, far] = [near, far].map(|interval| discrete.scalars[interval][i]);
        side.scalars[i] = near + part * (near - far);
    }
}

/// Returns true if inputs switch at an instant between two intervals.
fn jump(model: &Model, discrete: &DiscreteTrajectory, k: usize) -> bool {
    let inputs = model.variables.inputs();
    let [before, after] = match (discrete.ends.get(k - 1), discrete.ends.get(k)) {
        (Some(before), Some(after)) => [&before[1].values[..], &after[0].values[..]],
        _ => [k - 1, k].map(|interval| &discrete.scalars[interval][inputs.clone()]),
    };
    let size = before
        .iter()
        .chain(after)
        .fold(0.0_f64, |size, x| size.max(x.abs()));
    // Limits of what is continuous differ by rounding.
    before
        .iter()
        .zip(after)
        .any(|(a, b)| (a - b).abs() > 1e-9 * size)
}
