//! Weights, loads and voltages that grow along a path of equilibria: the rows of rest by them.

use crate::dynamics::equilibrium::statics::Statics;
use crate::dynamics::step_matrix::StepMatrix;
use crate::math::Vector;
use crate::model::Role;

impl Statics<'_> {
    /// Inputs with all voltages zero.
    pub(super) fn without_voltages(&self, inputs: &[f64]) -> Vec<f64> {
        let variables = &self.model.variables;
        variables.inputs_where(inputs, |role| role != Role::Voltage)
    }

    /// Returns true if a voltage is other than zero.
    pub(super) fn is_driven(&self, inputs: &[f64]) -> bool {
        let mut inputs = self.model.variables.with_roles(inputs);
        inputs.any(|(value, role)| role == Role::Voltage && value != 0.0)
    }

    /// Returns true if anything has a weight, or a load acts.
    pub(super) fn has_weight(&self) -> bool {
        let acts = self.loads.iter().any(|load| *load != 0.0);
        acts || self.gravity.iter().any(|force| *force != Vector::zeros())
    }

    /// Adds the derivative of the rows by the part of the weights and loads that acts, at the state evaluated last.
    pub(super) fn add_weight(&self, rows: &mut [f64]) {
        let map = &self.model.action.map;
        map.pull_back(&self.a.columns, &self.gravity, &mut rows[..map.coordinates]);
        self.add_load(&self.loads, rows);
    }

    /// Adds the derivative of the rows along a change of the inputs, at the state evaluated last.
    pub(super) fn add_load(&self, change: &[f64], rows: &mut [f64]) {
        let variables = &self.model.variables;
        let change = &variables.scalars(change);
        if let StepMatrix::Grids(grids) = &self.matrix {
            let (map, nodes) = (&self.model.action.map, grids.nodes());
            for (vector, s, sum) in nodes.of_vectors() {
                map.pull_back_one(vector, &[], &(sum * change[s]), rows);
            }
            for (s, t, sum) in nodes.of_scalars() {
                if let Some(row) = variables.place(s) {
                    rows[row] += sum * change[t];
                }
            }
            return;
        }
        let layout = self.model.action.layout();
        for side in 0..2 {
            for (slot, (i, s)) in layout.mixed.entries().enumerate() {
                if variables.place(s).is_none() {
                    rows[i] += self.values[layout.mixed_at(0, side) + slot] * change[s];
                }
            }
        }
        for (slot, (s, t)) in layout.scalars.entries().enumerate() {
            if let (Some(row), None) = (variables.place(s), variables.place(t)) {
                rows[row] += self.values[layout.scalars_at(0) + slot] * change[t];
            }
        }
    }
}
