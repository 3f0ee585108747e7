//! Inputs that hold a goal, sought with the motion: the goal is a state of rest, and one interval behind the motion keeps it.
//!
//! In an interval whose ends have the same coordinates q nothing moves, and both discrete forces are the static ones, −h/2 ∂V/∂q(q, u).
//! With the rest of the motion before it, the balances of the instants N and N + 1 say that q is an equilibrium under the inputs u of that interval:
//!
//! ```text
//! D₂L_d(q_{N−1}, q_N) + D₁L_d(q_N, q_N; u) = 0,     D₂L_d(q_N, q_N; u) = 0.
//! ```

use crate::control::error::BoundaryError;
use crate::control::problem::{BoundaryState, Control};
use crate::model::Model;

/// Refuses to seek what holds a goal where nothing can: nodes and what muscles remember have no rest of their own there.
pub(super) fn check(model: &Model, control: &Control) -> Result<(), BoundaryError> {
    if !control.seeks_hold {
        return Ok(());
    }
    let refused = |reason: &str| {
        Err(BoundaryError::Hold {
            reason: reason.to_owned(),
        })
    };
    let is_open = match &control.goal {
        BoundaryState::JointAngles { .. } => true,
        BoundaryState::Markers { hold, .. } => hold.is_none(),
        _ => false,
    };
    if !is_open {
        return refused(
            "inputs that hold a goal are sought for places or joint coordinates without given ones",
        );
    }
    if !model.solids.is_empty() {
        return refused(
            "\"find\" is for lumped muscles: a few voltages cannot hold every node of an elastic block where the motion leaves it; name the voltages",
        );
    }
    if model.memory().next().is_some() {
        return refused(
            "\"find\" is for muscles without circuits that do not creep: no constant voltages keep what these remember",
        );
    }
    Ok(())
}
