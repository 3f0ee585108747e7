//! The record of a motion: coordinates, momenta and voltages on a time grid.

use crate::dynamics::StepperReport;

/// N + 1 instants and N intervals.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct History {
    /// Times of the instants in ms.
    pub times: Vec<f64>,
    /// Coordinates and multipliers of each instant; multipliers of the last instant are those before it.
    pub z: Vec<Vec<f64>>,
    /// Momentum of each coordinate at each instant.
    pub momenta: Vec<Vec<f64>>,
    /// Rates of the coordinates at the start, where they are known.
    pub rates: Option<Vec<f64>>,
    /// Voltages of each interval in V and potentials in their unit, by scalar of the interval.
    pub scalars: Vec<Vec<f64>>,
    /// The method that factorised the tangents of the steps.
    pub solver: &'static str,
    /// What it cost.
    pub report: StepperReport,
}

impl History {
    /// Number of intervals.
    pub fn intervals(&self) -> usize {
        self.scalars.len()
    }
}
