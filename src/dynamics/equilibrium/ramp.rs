//! Loads that grow along a path of equilibria: first the weights, then the voltages.

use crate::dynamics::equilibrium::instability::Load;
use crate::dynamics::equilibrium::statics::Statics;

/// A load that grows, and the voltages when all of it acts.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ramp<'v> {
    pub(super) load: Load,
    pub(super) voltages: &'v [f64],
}

impl Ramp<'_> {
    /// Lets a fraction of the weights act; returns the voltages of a fraction.
    pub(super) fn apply(&self, statics: &mut Statics<'_>, fraction: f64) -> Vec<f64> {
        let (weight, part) = match self.load {
            Load::Weight => (fraction, 0.0),
            Load::Voltages => (1.0, fraction),
        };
        statics.weight = weight;
        self.voltages.iter().map(|v| v * part).collect()
    }

    /// Adds the derivative of the rows by the fraction, at the state evaluated last.
    pub(super) fn add(&self, statics: &Statics<'_>, rows: &mut [f64]) {
        match self.load {
            Load::Weight => statics.add_weight(rows),
            Load::Voltages => statics.add_load(self.voltages, rows),
        }
    }

    /// The fraction at a part of the way that a path takes: forces of voltages grow with their squares.
    pub(super) fn fraction(&self, part: f64) -> f64 {
        match self.load {
            Load::Weight => part,
            Load::Voltages => part.sqrt(),
        }
    }
}
