//! Stiffness, stability and softest mode of a state of rest.

use crate::dynamics::equilibrium::rest_state::RestState;
use crate::dynamics::equilibrium::result::{Equilibrium, Route};
use crate::dynamics::equilibrium::softest_mode::{softest_mode, stiffness};
use crate::dynamics::equilibrium::statics::Statics;
use crate::model::Model;

impl Equilibrium {
    /// Stiffness, stability and softest mode of a model's state of rest: `z` of coordinates and multipliers, `scalars` of
    /// voltages and potentials.
    pub fn of_state(model: &Model, z: &[f64], scalars: &[f64]) -> Self {
        let [voltages, others] = model.variables.split(scalars);
        let mut statics = Statics::new(model, voltages);
        let state = statics.state(z, others);
        Self::new(&mut statics, &state, voltages, Route::Loads)
    }

    /// A state of rest of a model, from coordinates with multipliers and potentials.
    pub(super) fn new(
        statics: &mut Statics<'_>,
        state: &RestState,
        voltages: &[f64],
        route: Route,
    ) -> Self {
        let point = Self::on_path(statics, state, voltages, route);
        Self {
            softest: softest_mode(statics, state, voltages),
            ..point
        }
    }

    /// The same without its softest mode.
    pub(super) fn on_path(
        statics: &mut Statics<'_>,
        state: &RestState,
        voltages: &[f64],
        route: Route,
    ) -> Self {
        let m = statics.model.action.map.unknowns();
        statics.evaluate(state, voltages);
        let is_known = statics.factor().is_ok();
        let unstable = is_known.then(|| statics.unstable_anyhow()).flatten();
        let follows = statics.inertia.symmetric_part.is_some();
        let may_flutter = follows && unstable == Some(0) && statics.falling() != Some(0);
        Self {
            z: statics.configuration(state),
            scalars: voltages.iter().chain(&state[m..]).copied().collect(),
            stiffness: stiffness(statics),
            unstable,
            may_flutter,
            lowest: statics.lowest_mode().cloned(),
            softest: None,
            route,
            iterations: statics.iterations,
            on_grids: statics.iterations_on_grids(),
        }
    }
}
