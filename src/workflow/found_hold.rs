//! Inputs that hold the goal of a motion, found with it.

use crate::control::BoundaryConditions;
use crate::dynamics::trajectory::by_source;
use crate::dynamics::{DiscreteTrajectory, Equilibrium};
use crate::math::significant;
use crate::model::Model;
use crate::model::system::Source;

/// A part of the largest input that holds a goal; smaller ones are not named.
const HARDLY: f64 = 1e-3;

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

/// Names the inputs that were found and hold the goal, without those that are hardly any.
pub(crate) fn note(model: &Model, held: &[f64]) -> String {
    let counted = |(source, value): (&Source, &f64)| {
        let (unit, size) = source.kind.counted();
        (source.name.clone(), value / size, unit)
    };
    let all: Vec<_> = model.sources.iter().zip(held).map(counted).collect();
    let largest = all
        .iter()
        .fold(0.0, |most: f64, (_, value, _)| most.max(value.abs()));
    let named = all
        .iter()
        .filter(|(_, value, _)| value.abs() > HARDLY * largest);
    let named =
        named.map(|(name, value, unit)| format!("{name} {} {unit}", significant(*value, 4)));
    let named: Vec<String> = named.collect();
    match named.is_empty() {
        true => "the goal was found to be held without any voltage or load".to_owned(),
        false => format!(
            "the goal is held by inputs that were found with the motion: {}",
            named.join(", ")
        ),
    }
}
