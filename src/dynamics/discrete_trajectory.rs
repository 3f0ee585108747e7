//! The record of a motion: coordinates, momenta and voltages on a time grid.
//!
//! Inputs at an instant: the limits from the intervals on both of its sides, with weights of which the sum is 1.
//!
//! A quantity of the table is the mean of its values on both sides, each weighted by the length of the other interval. Where the inputs are
//! continuous both are equal; where they switch it is a mean of both; where they are constant over intervals it is of second order.

use crate::dynamics::energies::Work;
use crate::dynamics::solving::Inputs;
use crate::dynamics::step_state::{StepState, StepperReport};
use crate::model::Model;

/// N + 1 instants and N intervals.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct DiscreteTrajectory {
    /// Times of the instants in ms.
    pub times: Vec<f64>,
    /// Coordinates and multipliers of each instant; multipliers of the last instant are those before it.
    pub z: Vec<Vec<f64>>,
    /// Momentum of each coordinate at each instant.
    pub momenta: Vec<Vec<f64>>,
    /// Rates of the coordinates at the start, where they are known.
    pub rates: Option<Vec<f64>>,
    /// Time in ms to which prescribed motions have come at the start.
    pub begun: f64,
    /// Voltages of each interval in V and potentials in their unit, by scalar of the interval.
    pub scalars: Vec<Vec<f64>>,
    /// Inputs at both ends of each interval; empty where they are constant in all of them.
    pub ends: Vec<[Inputs; 2]>,
    /// Scalars after the last interval, where the inputs that hold the end of the motion were found with it.
    pub held: Option<Vec<f64>>,
    /// Times at which energies and momenta are read.
    pub reading: Reading,
    /// Work of forces without a potential in each interval, where instants alone do not determine it.
    pub works: Vec<Work>,
    /// The method that factorised the tangents of the steps.
    pub solver: String,
    /// Report of the steps.
    pub report: StepperReport,
    /// State from which the motion can be resumed.
    pub end: StepState,
}

/// Times to which the energies and momenta of a method belong.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Reading {
    /// At the midpoints of intervals, where the midpoint rule sees energies.
    #[default]
    Intervals,
    /// At instants, by their momenta.
    Instants,
    /// At instants, each with the inputs and potentials of the interval that ends there: equilibria.
    States,
}

impl DiscreteTrajectory {
    /// Number of intervals.
    pub fn intervals(&self) -> usize {
        self.scalars.len()
    }
}

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
