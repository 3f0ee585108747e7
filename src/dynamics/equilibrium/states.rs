//! States of rest of a model: made, moved, and seen from charts where their bodies are.

use crate::dynamics::equilibrium::rest_state::RestState;
use crate::dynamics::equilibrium::static_matrix::turned_pairs;
use crate::dynamics::equilibrium::statics::Statics;

impl Statics<'_> {
    /// The state at a configuration, potentials being zero.
    pub(super) fn state_without_field(&self, z: &[f64]) -> RestState {
        let scalars = vec![0.0; self.model.variables.algebraic().len()];
        self.state(z, &scalars)
    }

    /// The state at a configuration with scalars that have an equation. Its charts are where its bodies are: there turns are rotations about the
    /// axes of the ground or of a parent, without singularity, and a stiffness by them does not depend on the choice of these axes.
    pub(super) fn state(&self, z: &[f64], scalars: &[f64]) -> RestState {
        let map = &self.model.action.map;
        let mut instant = map.placed(z);
        map.recentre(&mut instant);
        let (unknowns, charts) = instant.z.split_at(map.unknowns());
        RestState {
            unknowns: [unknowns, scalars].concat(),
            charts: charts.to_vec(),
        }
    }

    /// Coordinates, multipliers and charts of a state.
    pub(super) fn configuration(&self, state: &RestState) -> Vec<f64> {
        let m = self.model.action.map.unknowns();
        [&state[..m], state.charts()].concat()
    }

    /// The state a step along a direction away: bodies behind charts turn by rotation vectors, so that no choice of axes matters.
    pub(super) fn moved(&self, state: &RestState, step: f64, direction: &[f64]) -> RestState {
        let mut moved = state.clone();
        let RestState { unknowns, charts } = &mut moved;
        self.model
            .action
            .map
            .advance(step, direction, unknowns, charts);
        moved
    }

    /// Makes second derivatives by turns those by rotation vectors, at turns of zero: a product of turns a, b, c about e₁, e₂, e₃ is the
    /// rotation vector a e₁ + b e₂ + c e₃ + ½ (a b e₁ × e₂ + a c e₁ × e₃ + b c e₂ × e₃) + …
    pub(super) fn add_curvature(&mut self) {
        let pairs = self.charted.iter().flat_map(turned_pairs);
        let signs = self
            .handedness
            .iter()
            .flat_map(|s| [-0.5 * s, 0.5 * s, -0.5 * s]);
        for ((place, [_, _, third]), sign) in pairs.enumerate().zip(signs) {
            self.values[self.curved + place] = sign * self.residual[third];
        }
    }

    /// Leaves the second derivatives evaluated last by turns: those by one on which nothing depends are zero, whatever the forces.
    pub(super) fn leave_out_curvature(&mut self) {
        self.values[self.curved..self.added].fill(0.0);
    }
}
