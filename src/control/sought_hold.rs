//! Inputs that hold a goal, sought with the motion: the goal is a state of rest, and one interval behind the motion keeps it.
//!
//! In an interval whose ends have the same coordinates q nothing moves, and both discrete forces are the static ones, −h/2 ∂V/∂q(q, u).
//! With the rest of the motion before it, the balances of the instants N and N + 1 say that q is an equilibrium under the inputs u of that interval:
//!
//! ```text
//! D₂L_d(q_{N−1}, q_N) + D₁L_d(q_N, q_N; u) = 0,     D₂L_d(q_N, q_N; u) = 0.
//! ```

use crate::control::error::BoundaryError;
use crate::control::problem::{BoundaryState, Control, Duration, SoughtHold};
use crate::model::Model;

impl Control {
    /// Returns true if the inputs that hold the goal are sought with the motion.
    pub fn seeks_hold(&self) -> bool {
        self.sought_hold == SoughtHold::Always
    }

    /// Returns true if the goal names places or joint coordinates and no voltages that hold it.
    pub fn names_no_hold(&self) -> bool {
        match &self.goal {
            BoundaryState::JointAngles { .. } => true,
            BoundaryState::Markers { hold, .. } => hold.is_none(),
            _ => false,
        }
    }
}

/// The reason why nothing that holds a goal can be sought: nodes and what muscles remember have no rest of their own there.
pub(crate) fn obstacle(model: &Model, control: &Control) -> Option<&'static str> {
    if !control.names_no_hold() {
        return Some(
            "inputs that hold a goal are sought for places or joint coordinates without given ones",
        );
    }
    if !model.solids.is_empty() {
        return Some(
            "\"find\" is for lumped muscles: a few voltages cannot hold every node of an elastic block where the motion leaves it; name the voltages",
        );
    }
    let from = match control.duration {
        Duration::Given(end) => end,
        Duration::Free { min, .. } => min,
    };
    let mut functions = (0..model.sources.len()).filter_map(|source| control.function(source));
    if functions.any(|function| function.constant_within([from, f64::INFINITY]).is_none()) {
        return Some(
            "\"find\" is for given inputs that are constant from the end on: nothing rests under one that goes on",
        );
    }
    model.creeps().then_some(
        "\"find\" is for muscles that do not creep: no constant voltages keep a stretch that relaxes",
    )
}

/// Refuses to seek what holds a goal where nothing can.
pub(super) fn check(model: &Model, control: &Control) -> Result<(), BoundaryError> {
    let reason = match control.seeks_hold() {
        true => obstacle(model, control),
        false => None,
    };
    reason.map_or(Ok(()), |reason| {
        Err(BoundaryError::Hold {
            reason: reason.to_owned(),
        })
    })
}
