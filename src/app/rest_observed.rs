//! Observations at rest.

use crate::dynamics::trajectory::Observations;

/// Reduces observations to those of a state of rest: neither time nor rates nor what follows from them.
pub(super) fn at_rest(mut observed: Observations) -> Observations {
    let moves = |name: &str| {
        let of_motion = ["linear_momentum", "angular_momentum", "kinetic_energy"];
        let others = ["time", "dissipated_energy"];
        others.contains(&name) || of_motion.iter().any(|word| name.starts_with(word))
    };
    observed.columns.retain(|column| !moves(&column.name));
    observed
}
