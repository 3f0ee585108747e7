//! Inputs that hold the goal of a motion, found with it.

use crate::control::BoundaryConditions;
use crate::dynamics::trajectory::by_source;
use crate::dynamics::{DiscreteTrajectory, Equilibrium};
use crate::math::significant;
use crate::model::Model;
use crate::model::system::Source;

/// Makes the goal of a motion the state of rest that it is, under the inputs that were found with it; nothing where none were.
///
/// Its stability is known where the coordinates are free of constraints.
pub(crate) fn keep(model: &Model, boundary: &mut BoundaryConditions, motion: &DiscreteTrajectory) {
    let (Some(held), Some(z)) = (&motion.held, motion.z.last()) else {
        return;
    };
    boundary.rest[1] = Some(by_source(model, held));
    if model.action.map.multipliers == 0 {
        boundary.goal.rest = Some(Equilibrium::of_state(model, z, held));
    }
}

/// Names the inputs that were found and hold the goal.
pub(crate) fn note(model: &Model, held: &[f64]) -> String {
    let acting = model
        .sources
        .iter()
        .zip(held)
        .filter(|(source, value)| source.acts() && **value != 0.0);
    let named = acting.map(|(source, value): (&Source, &f64)| {
        let (unit, size) = source.kind.counted();
        format!("{} {} {unit}", source.name, significant(value / size, 4))
    });
    let named: Vec<String> = named.collect();
    match named.is_empty() {
        true => "the goal was found to be held without any voltage or load".to_owned(),
        false => format!(
            "the goal is held by inputs that were found with the motion: {}",
            named.join(", ")
        ),
    }
}
