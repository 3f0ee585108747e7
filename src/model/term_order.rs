//! The terms of the library in the order of the sum of the action: inertia, potentials, virtual works, constraints. Terms of other crates follow.

use crate::model::terms::{GRAVITY, LeftOut, Present};

/// A term: its name, and the reason why it is absent where the scene gives no other one.
type Row = (&'static str, &'static str);

const NO_MUSCLE: &str = "no lumped muscle";
const NO_MUSCLE_BY_LAW: &str = "no lumped muscle names a law of elasticity";
const NO_MUSCLE_BRANCH: &str = "no lumped muscle that moves names a Maxwell branch";
const NO_BLOCK: &str = "no elastic block";
const NO_BLOCK_BY_LAW: &str = "no elastic block that moves names a law of elasticity";
const NO_BLOCK_BRANCH: &str = "no elastic block that moves names a Maxwell branch";
const NO_CIRCUIT: &str = "no muscle or electrode names a circuit with a resistor";
const NO_WIRED_ELECTRODE: &str = "no electrode of finite elements names a circuit with a resistor";
const NO_CHARGE: &str = "no charge of a lumped muscle is given, or flows through a resistor";
const NO_LOAD: &str = "no load of its kind";
const NO_BODY: &str = "no body that moves";
const NO_END: &str = "no joint that calls for one";
const NO_CONTACT: &str = "no contact";
const NO_SPRING: &str = "no spring";

/// The terms of the library.
const TERMS: [Row; 40] = [
    ("body inertia", NO_BODY),
    ("muscle inertia", NO_MUSCLE),
    ("block inertia", NO_BLOCK),
    ("section inertia", NO_MUSCLE),
    (GRAVITY, "nothing that moves has a mass"),
    ("block elasticity", NO_BLOCK),
    ("block electroelasticity", NO_BLOCK),
    ("general block elasticity", NO_BLOCK_BY_LAW),
    ("general block electroelasticity", NO_BLOCK_BY_LAW),
    ("muscle elasticity", NO_MUSCLE),
    ("muscle electroelasticity", NO_MUSCLE),
    ("general muscle elasticity", NO_MUSCLE_BY_LAW),
    ("general muscle electroelasticity", NO_MUSCLE_BY_LAW),
    ("muscle charges", NO_CHARGE),
    ("maxwell elasticity", NO_MUSCLE_BRANCH),
    ("block maxwell elasticity", NO_BLOCK_BRANCH),
    ("joint elasticity", "no joint that moves names a stiffness"),
    ("joint stops", "no joint that moves names stops"),
    ("spring elasticity", NO_SPRING),
    ("tendon elasticity", "no tendon"),
    ("contact elasticity", NO_CONTACT),
    ("loads", NO_LOAD),
    ("surface charges", NO_LOAD),
    ("electrode charges", NO_WIRED_ELECTRODE),
    ("circuit sources", NO_CIRCUIT),
    ("following loads", NO_LOAD),
    ("block viscosity", NO_BLOCK),
    ("muscle viscosity", NO_MUSCLE),
    ("maxwell viscosity", NO_MUSCLE_BRANCH),
    ("block maxwell viscosity", NO_BLOCK_BRANCH),
    ("circuit resistance", NO_CIRCUIT),
    ("joint damping", "no joint that moves names a damping"),
    ("spring damping", NO_SPRING),
    ("contact damping", NO_CONTACT),
    ("contact friction", NO_CONTACT),
    ("rigid bodies", NO_BODY),
    ("joint directions", NO_END),
    ("joint points", NO_END),
    ("joint coordinates", "no joint names a stiffness"),
    ("glue", "no node is glued to a body that moves"),
];

/// Names of the terms of the library, in the order of the sum.
pub fn terms() -> impl Iterator<Item = &'static str> {
    TERMS.into_iter().map(|(name, _)| name)
}

/// Place of a term in the sum.
pub(super) fn rank(term: &str) -> usize {
    let place = terms().position(|name| name == term);
    place.unwrap_or(usize::MAX)
}

/// Keeps the first reason for each term that is not there, in the order of the sum.
pub(super) fn settle(present: &[Present], left_out: &mut Vec<LeftOut>) {
    left_out.extend(TERMS.map(|(term, why)| LeftOut { term, why }));
    let is_there = |term| present.iter().any(|p| p.term == term);
    left_out.retain(|l| !is_there(l.term));
    left_out.sort_by_key(|l| rank(l.term));
    left_out.dedup_by_key(|l| l.term);
}
