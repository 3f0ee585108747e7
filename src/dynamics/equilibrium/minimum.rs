//! Minima of the potential energy near a state, all loads acting.
//!
//! Newton's direction on the stiffness K + σ B, with B of the scales of the coordinates and σ ≥ 0 as small as makes it
//! positive definite where constraints and Gauss's law hold, by the inertia of its factorisation. The energy is that of states
//! brought onto the constraints with potentials by Gauss's law, and falls in each step.

use crate::dynamics::equilibrium::rest_state::RestState;
use crate::dynamics::equilibrium::statics::Statics;
use crate::dynamics::singular_configurations::{reversed, shortest};
use crate::ipopt::interrupt;

/// Limit of steps, and that for models with nodes.
const STEPS: [usize; 2] = [300, 60];
/// Longest step, in radians and lengths of the system.
const LONGEST: f64 = 0.3;
/// Size of the last step.
const UPDATE: f64 = 1e-9;
/// Part of the decrease that the slope promises.
const ARMIJO: f64 = 1e-4;
/// Halvings of one step.
const HALVINGS: usize = 30;
/// Muscles shorter than this part of their length have collapsed.
pub(super) const COLLAPSED: f64 = 0.03;

/// A state of least potential energy by descent from another; `None` where the energy falls without end.
pub(super) fn minimise(
    statics: &mut Statics<'_>,
    from: &RestState,
    voltages: &[f64],
) -> Option<RestState> {
    statics.weight = 1.0;
    let model = statics.model;
    let n = model.action.map.coordinates;
    let mut state = from.clone();
    statics.settle(&mut state, voltages)?;
    let mut energy = statics.energy(&state, voltages);
    if !energy.is_finite() {
        return None;
    }
    let mut placed = statics.instant().clone();
    let steps = STEPS[usize::from(!model.action.map.of_nodes.is_empty())];
    let mut sigma = 0.0;
    for _ in 0..steps {
        if interrupt::stop().is_some() {
            return None;
        }
        statics.iterations += 1;
        statics.evaluate(&state, voltages);
        let rows = statics.residual.clone();
        sigma = convexify(statics, sigma)?;
        let mut update = rows.clone();
        statics.solve(&mut update);
        let size = statics.size(&update);
        if !size.is_finite() {
            return None;
        }
        if size < UPDATE && sigma == 0.0 {
            return Some(state);
        }
        let mut part = if size > LONGEST { LONGEST / size } else { 1.0 };
        // Rows are −h ∇V, and the step is −update.
        let slope: f64 = rows[..n].iter().zip(&update).map(|(r, u)| r * u).sum();
        let slope = slope / model.multiplier_time;
        let mut is_accepted = false;
        for _ in 0..HALVINGS {
            let mut trial = statics.moved(&state, -part, &update);
            if statics.settle(&mut trial, voltages).is_some() {
                let after = statics.energy(&trial, voltages);
                let noise = 1e-13 * energy.abs().max(after.abs());
                let falls = after <= energy + ARMIJO * part * slope + noise;
                if falls && reversed(model, &placed, statics.instant()).is_none() {
                    placed.clone_from(statics.instant());
                    (state, energy, is_accepted) = (trial, after, true);
                    break;
                }
            }
            part *= 0.5;
        }
        if !is_accepted || shortest(model, &placed).is_some_and(|(_, s)| s < COLLAPSED) {
            return None;
        }
        sigma *= 0.25;
    }
    None
}

/// Factorises the stiffness of the state evaluated last with the least of 0, σ, 4 σ, … that leaves no direction in which the
/// energy falls; returns it.
fn convexify(statics: &mut Statics<'_>, sigma: f64) -> Option<f64> {
    if statics.factor().is_ok() && statics.unstable() == Some(0) {
        return Some(0.0);
    }
    let mut sigma = f64::max(sigma, 1e-4 * statics.largest_stiffness());
    for _ in 0..40 {
        if statics.factor_with(sigma).is_ok() && statics.unstable() == Some(0) {
            return Some(sigma);
        }
        sigma *= 4.0;
    }
    None
}
