//! Stability without factors: the lowest eigenvalue of the stiffness of displacements that potentials follow, with a bound of its error.

use crate::dynamics::equilibrium::examined::{Examined, LowestMode};
use crate::dynamics::equilibrium::statics::Statics;
use crate::dynamics::solving::MultigridUse;
use crate::dynamics::step_matrix::StepMatrix;
use crate::ipopt::interrupt;
use crate::model::Model;
use crate::sparse::multigrid::LowestModes;

/// The lowest mode of a model at a state of rest: `z` of coordinates, `scalars` of voltages and potentials; `None` where something else than
/// nodes of blocks moves, or it is not found.
pub fn lowest_mode(model: &Model, z: &[f64], scalars: &[f64]) -> Option<LowestMode> {
    let [inputs, others] = model.variables.split(scalars);
    let mut statics = Statics::by(model, inputs, Some(MultigridUse::Always));
    let state = statics.state(z, others);
    statics.evaluate(&state, inputs);
    statics.factor().ok()?;
    statics.find_lowest_mode();
    statics.lowest_mode().cloned()
}

impl Statics<'_> {
    /// Finds the lowest mode at the state evaluated and taken last, where an iteration solves and it is not known already.
    pub(super) fn find_lowest_mode(&mut self) {
        let at = self.place_of_mode();
        let factor = -1.0 / self.model.multiplier_time;
        let StepMatrix::Grids(grids) = &mut self.matrix else {
            return;
        };
        if at == self.examined.at {
            return;
        }
        let found = grids.lowest_modes(factor, &|| interrupt::stop().is_some());
        self.multigrid.add(grids.counted());
        let count = self.model.action.map.coordinates;
        let found = found.ok().flatten().map(|modes| {
            let unstable = modes.below_zero();
            let LowestModes {
                quotients,
                bounds,
                iterations,
                lowest: mut direction,
                ..
            } = modes;
            direction.truncate(count);
            LowestMode {
                stiffness: quotients[0],
                bound: bounds[0],
                unstable,
                iterations,
                direction,
            }
        });
        self.examined = Examined { at, found };
    }

    /// The lowest mode of the state evaluated last, where it was found.
    pub(super) fn lowest_mode(&self) -> Option<&LowestMode> {
        let found = self.examined.found.as_ref().filter(|_| self.is_iterated());
        found.filter(|_| self.place_of_mode() == self.examined.at)
    }

    /// Number of directions in which the potential energy of the state evaluated and taken last falls, by factors or by the lowest mode.
    pub(super) fn unstable_anyhow(&mut self) -> Option<usize> {
        if !self.is_iterated() {
            return self.unstable();
        }
        self.find_lowest_mode();
        self.lowest_mode()?.unstable
    }

    /// All that the stiffness depends on.
    fn place_of_mode(&self) -> Vec<f64> {
        [&self.a.z[..], &self.scalars, &[self.weight]].concat()
    }
}
