//! Loads that grow along a path of equilibria: first the weights with the forces of the scene, then the voltages.

use crate::dynamics::equilibrium::rest_state::Load;
use crate::dynamics::equilibrium::statics::Statics;
use crate::model::Role;

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
            Load::Forces => (fraction, 0.0),
            Load::Voltages => (1.0, fraction),
        };
        statics.weight = weight;
        let variables = &statics.model.variables;
        let scaled = |(value, role)| {
            if role == Role::Voltage {
                value * part
            } else {
                value
            }
        };
        variables.with_roles(self.voltages).map(scaled).collect()
    }

    /// Adds the derivative of the rows by the fraction, at the state evaluated last.
    pub(super) fn add(&self, statics: &Statics<'_>, rows: &mut [f64]) {
        match self.load {
            Load::Forces => statics.add_weight(rows),
            Load::Voltages => {
                let variables = &statics.model.variables;
                let change = variables.inputs_where(self.voltages, |role| role == Role::Voltage);
                statics.add_load(&change, rows);
            }
        }
    }

    /// Derivative of the fraction by the part of the way at a fraction.
    pub(super) fn slope(&self, fraction: f64) -> f64 {
        match self.load {
            Load::Forces => 1.0,
            Load::Voltages => 0.5 / fraction,
        }
    }

    /// Derivative of the state by the fraction, −K⁻¹ b, at the state evaluated and factorised last.
    pub(super) fn response(&self, statics: &mut Statics<'_>) -> Vec<f64> {
        let mut load = vec![0.0; statics.residual.len()];
        self.add(statics, &mut load);
        statics.solve(&mut load);
        load.iter_mut().for_each(|v| *v = -*v);
        load
    }

    /// The fraction at a part of the way that a path takes: forces of voltages grow with their squares.
    pub(super) fn fraction(&self, part: f64) -> f64 {
        match self.load {
            Load::Forces => part,
            Load::Voltages => part.sqrt(),
        }
    }
}
