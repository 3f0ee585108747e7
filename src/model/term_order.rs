//! Order of the terms in the sum of the action: inertia, potentials, virtual works, constraints. Terms of other crates follow.

use crate::model::components::{DISSIPATIONS, POTENTIALS};
use crate::model::terms::GRAVITY;

/// Inertia and potentials before those of components.
const FIRST: [&str; 18] = [
    "body inertia",
    "muscle inertia",
    "block inertia",
    "section inertia",
    GRAVITY,
    "block elasticity",
    "block electroelasticity",
    "general block elasticity",
    "general block electroelasticity",
    "muscle elasticity",
    "muscle electroelasticity",
    "general muscle elasticity",
    "general muscle electroelasticity",
    "muscle charges",
    "maxwell elasticity",
    "block maxwell elasticity",
    "joint elasticity",
    "joint stops",
];

/// Terms between the potentials of components and their dissipation.
const MIDDLE: [&str; 11] = [
    "loads",
    "surface charges",
    "electrode charges",
    "circuit sources",
    "following loads",
    "block viscosity",
    "muscle viscosity",
    "maxwell viscosity",
    "block maxwell viscosity",
    "circuit resistance",
    "joint damping",
];

/// Constraints.
const LAST: [&str; 5] = [
    "rigid bodies",
    "joint directions",
    "joint points",
    "joint coordinates",
    "glue",
];

/// Names of the terms of the library, in the order of the sum.
pub fn terms() -> impl Iterator<Item = &'static str> {
    let of_components =
        |names: &'static [&[&'static str]]| names.iter().copied().flatten().copied();
    let potentials = FIRST.into_iter().chain(of_components(POTENTIALS));
    let works = MIDDLE.into_iter().chain(of_components(DISSIPATIONS));
    potentials.chain(works).chain(LAST)
}

/// Place of a term in the sum.
pub(super) fn rank(term: &str) -> usize {
    let place = terms().position(|name| name == term);
    place.unwrap_or(usize::MAX)
}
