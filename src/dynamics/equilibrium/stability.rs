//! Stiffness, stability and softest mode of a state of rest, and its slowest vibration: K v = ω² M v with the smallest ω², without damping.
//!
//! The iteration K u = M v converges to v; ω² is the quotient uᵀ K u / uᵀ M u with K u = M v. Multipliers and potentials follow the
//! coordinates.

use crate::dynamics::equilibrium::rest_state::RestState;
use crate::dynamics::equilibrium::result::{Equilibrium, Route};
use crate::dynamics::equilibrium::softest_mode::{softest_mode, stiffness};
use crate::dynamics::equilibrium::statics::Statics;
use crate::math::Random;
use crate::model::Model;
use crate::stop;
use std::f64::consts::TAU;

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

/// Maximum number of iterations, and the relative change of ω² that ends them.
const STEPS: usize = 200;
const SAME: f64 = 1e-6;

impl Equilibrium {
    /// Period in ms of the slowest vibration about the state of rest of a model, without damping; `None` if the state is unstable, nothing
    /// that moves has inertia, or no period is found.
    pub fn slowest_period(&self, model: &Model) -> Option<f64> {
        let [inputs, others] = model.variables.split(&self.scalars);
        let mut statics = Statics::new(model, inputs);
        let state = statics.state(&self.z, others);
        statics.evaluate(&state, inputs);
        statics.factor().ok()?;
        if statics.unstable().is_some_and(|count| count > 0) {
            return None;
        }
        let mut instant = model.action.map.placed(&self.z);
        let (n, size) = (model.coordinate_count(), statics.residual.len());
        let mut random = Random::new(1);
        let scales = statics.scales().iter().copied();
        let scales = scales.map(|scale| if scale.is_finite() { scale } else { 1.0 });
        let first: Vec<f64> = scales.map(|s| s * random.between(-1.0, 1.0)).collect();
        let mut momentum = model.action.momentum(&mut instant, &first);
        let mut last = 0.0;
        for _ in 0..STEPS {
            if stop::reason().is_some() {
                return None;
            }
            // The tangent is −h K.
            let of_tangent = momentum.iter().map(|p| -model.multiplier_time * p);
            let mut rates: Vec<f64> = of_tangent.collect();
            rates.resize(size, 0.0);
            statics.solve(&mut rates);
            rates.truncate(n);
            let after = model.action.momentum(&mut instant, &rates);
            let kinetic = dot(&rates, &after);
            let square = dot(&rates, &momentum) / kinetic;
            if !(square.is_finite() && square > 0.0) {
                return None;
            }
            if (square - last).abs() <= SAME * square {
                return Some(TAU / square.sqrt());
            }
            last = square;
            momentum = after.iter().map(|p| p / kinetic.sqrt()).collect();
        }
        None
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
