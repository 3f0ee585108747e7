//! Periodic motions: the start is sought, and the end has its coordinates and momenta.
//!
//! The last instant shares the coordinates of the first one, and their balances are one:
//!
//! ```text
//! D₂L_d(q_{N−1}, q_0) + D₁L_d(q_0, q_1) + f⁺ + f⁻ = 0.
//! ```

use crate::control::error::BoundaryError;
use crate::control::problem::{BoundaryState, Control, Duration};
use crate::math::Signal;
use crate::model::{Model, joint_unit};

/// Parts of a radian or of the length of the system by which a prescribed motion may miss its start, and by which its rate may over the duration.
const SAME: f64 = 1e-9;

/// Refuses what has no meaning of a motion without a start, or does not repeat.
pub(super) fn check(model: &Model, control: &Control) -> Result<(), BoundaryError> {
    if control.goal != BoundaryState::Periodic {
        return Ok(());
    }
    let refused = |reason: &str| Err(BoundaryError::refused("goal", reason));
    if !control.objective.energies.is_empty() {
        return refused(
            "energies of sources are no costs of a periodic motion; take \"effort\" or \"rate\"",
        );
    }
    if control.intervals < 2 {
        return refused("a periodic motion needs at least two intervals");
    }
    // What is read in the middle of intervals alone may alternate from instant to instant in a ring of an even number of them.
    if model.memory().next().is_some() {
        return refused(
            "periodic motions are those of muscles and blocks that do not creep and have no circuit",
        );
    }
    for (source, named) in model.sources.iter().enumerate() {
        let function = control.function(source);
        if function.is_some_and(|function| !repeats(function, control.duration)) {
            return refused(&format!(
                "the given input of {} is a function of time that does not repeat after the duration of a periodic motion",
                named.name
            ));
        }
    }
    for one in &model.prescribed {
        let Duration::Given(end) = control.duration else {
            continue;
        };
        let size = match joint_unit(&model.system, one.joint) {
            "mm" => model.length(),
            _ => 1.0,
        };
        let [first, last] = [0.0, end].map(|time| one.motion.derivatives(time));
        let pairs = first.iter().zip(last).zip([1.0, end]);
        let changes = pairs.map(|((a, b), per)| (a - b).abs() * per);
        if changes.fold(0.0, f64::max) > SAME * size {
            let name = &model.system.joints[one.joint].name;
            return refused(&format!(
                "joint \"{name}\" has a prescribed motion that does not come back after the duration of a periodic motion"
            ));
        }
    }
    Ok(())
}

/// Returns true if a function of time has the period of a motion.
fn repeats(function: &Signal, duration: Duration) -> bool {
    match (function, duration) {
        (Signal::Sine { frequency, .. }, Duration::Given(end)) => {
            let turns = frequency * end;
            (turns - turns.round()).abs() < SAME * turns.abs().max(1.0)
        }
        _ => function.constant_within([0.0, f64::INFINITY]).is_some(),
    }
}
