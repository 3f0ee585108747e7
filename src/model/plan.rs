//! Plan of the action: the reasons why each term is present or absent.

use crate::model::components::{DISSIPATIONS, POTENTIALS};

/// Weight, the one term that acts in every place with a mass.
pub(super) const GRAVITY: &str = "gravity";

/// Term that is present, with its reason.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Present {
    /// Name of the term.
    pub term: &'static str,
    /// Reason, before the names: "stiffness of".
    pub why: &'static str,
    /// Names of the parts of the scene that do.
    pub of: Vec<String>,
}

/// A term that is left out.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LeftOut {
    /// Name of the term.
    pub term: &'static str,
    /// Reason why it is absent.
    pub why: &'static str,
}

/// Keeps the first reason for each term that is not there, in the order of the sum, in which `rank` is the place of a term.
pub(super) fn settle(
    present: &[Present],
    left_out: &mut Vec<LeftOut>,
    rank: impl Fn(&str) -> usize,
) {
    let is_there = |term| present.iter().any(|p| p.term == term);
    left_out.retain(|l| !is_there(l.term));
    left_out.sort_by_key(|l| rank(l.term));
    left_out.dedup_by_key(|l| l.term);
}

/// Notes that a part of the scene calls for a term.
pub(super) fn note(present: &mut Vec<Present>, term: &'static str, why: &'static str, of: &str) {
    let same = |p: &&mut Present| p.term == term && p.why == why;
    match present.iter_mut().rev().find(same) {
        // Parts come one after the other.
        Some(known) if known.of.last().is_some_and(|last| last == of) => {}
        Some(known) => known.of.push(of.to_owned()),
        None => present.push(Present {
            term,
            why,
            of: vec![of.to_owned()],
        }),
    }
}

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
