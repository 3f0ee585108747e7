//! Inputs that hold the goal of a motion, found with it.

use crate::control::{BoundaryConditions, Rests};
use crate::dynamics::trajectory::by_source;
use crate::dynamics::{DiscreteTrajectory, Equilibrium};
use crate::math::significant;
use crate::model::Model;
use crate::model::system::Source;

/// A part of the largest input that holds a goal; smaller ones are not named.
const HARDLY: f64 = 1e-3;

/// Makes the goal of a motion the state of rest that it is, under the inputs that were found with it or that the goal names.
///
/// Its stability is known where the coordinates are free of constraints.
pub(crate) fn keep(model: &Model, boundary: &mut BoundaryConditions, motion: &DiscreteTrajectory) {
    let Some(z) = motion.z.last() else {
        return;
    };
    let held = match &motion.held {
        Some(found) => {
            boundary.rest[1] = Some(by_source(model, found));
            found.clone()
        }
        None => match named(model, boundary) {
            Some(named) => named,
            None => return,
        },
    };
    if model.action.map.multipliers == 0 {
        boundary.goal.rest = Some(Equilibrium::of_state(model, z, &held));
    }
}

/// Scalars of an interval with the inputs under which all of the system rests at a goal whose state was found; none where potentials follow from
/// them, or the goal was known to be an equilibrium.
fn named(model: &Model, boundary: &BoundaryConditions) -> Option<Vec<f64>> {
    let goal = &boundary.goal;
    let is_open = goal.rest.is_none() && goal.rests == Rests::Everything;
    let inputs = boundary.rest[1].as_ref().filter(|_| is_open)?;
    let scalars = model.variables.scalars(&model.scalars(inputs));
    let [_, others] = model.variables.split(&scalars);
    others.is_empty().then_some(scalars)
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
