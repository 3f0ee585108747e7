//! Overdamped motion from a state to rest, all loads acting: B q̇ = f(q), with the forces f and B of the scales of the coordinates.
//!
//! Implicit Euler steps with one Newton iteration each, (B/Δt − ∂f/∂q) Δq = f, as long as Δt admits: no motion grows by the matrix, and the
//! step is short (pseudo-transient continuation). Forces need no potential: loads may follow what they act on.

use crate::dynamics::equilibrium::rest_state::RestState;
use crate::dynamics::equilibrium::statics::Statics;
use crate::dynamics::singular_configurations::{reversed, shortest};
use crate::ipopt::interrupt;

/// Limit of steps.
const STEPS: usize = 1000;
/// Longest step, in radians and lengths of the system.
const LONGEST: f64 = 0.1;
/// Size of the last step, without damping.
const UPDATE: f64 = 1e-9;
/// Part of the damping and of the longest step at which the damping changes.
const CUT: f64 = 0.25;
/// Damping below this part of the largest stiffness is none, and beyond its inverse nothing moves. Bent blocks of square sections are so soft
/// when they turn about their axis.
const NONE: f64 = 1e-13;
/// Muscles shorter than this part of their length have collapsed.
const COLLAPSED: f64 = 0.03;

/// The state at which the overdamped motion from another comes to rest; `None` where it does not.
pub(super) fn relax(
    statics: &mut Statics<'_>,
    from: &RestState,
    voltages: &[f64],
) -> Option<RestState> {
    statics.weight = 1.0;
    let model = statics.model;
    let mut state = from.clone();
    statics.settle(&mut state, voltages)?;
    statics.evaluate(&state, voltages);
    let mut placed = statics.instant().clone();
    let largest = statics.largest_stiffness();
    let mut damping = largest;
    for _ in 0..STEPS {
        if interrupt::stop().is_some() || damping * NONE > largest {
            return None;
        }
        statics.iterations += 1;
        let is_free = damping < NONE * largest;
        let is_factored = match is_free {
            true => statics.factor().is_ok(),
            false => statics.factor_with(damping).is_ok(),
        };
        if !is_factored || statics.unstable() != Some(0) {
            damping = f64::max(damping, NONE * largest) / CUT;
            continue;
        }
        let mut update = statics.residual.clone();
        statics.solve(&mut update);
        let size = statics.size(&update);
        if is_free && size < UPDATE {
            return Some(state);
        }
        let is_short = size < LONGEST;
        let trial = statics.moved(&state, -1.0, &update);
        if is_short {
            statics.evaluate(&trial, voltages);
        }
        let is_there = statics.residual.iter().all(|row| row.is_finite());
        if !is_short || !is_there || reversed(model, &placed, statics.instant()).is_some() {
            damping = f64::max(damping, NONE * largest) / CUT;
            statics.evaluate(&state, voltages);
            continue;
        }
        placed.clone_from(statics.instant());
        if shortest(model, &placed).is_some_and(|(_, s)| s < COLLAPSED) {
            return None;
        }
        if size < CUT * LONGEST {
            damping *= CUT;
        }
        state = trial;
    }
    None
}
