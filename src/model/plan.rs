//! Plan of the action: names of the terms in the order in which they are summed, and the reasons why each is present or
//! absent.

/// Weight, the one term that acts in every place with a mass.
pub(super) const GRAVITY: &str = "gravity";

/// Names of the terms of the library, in the order of the sum; those of other crates follow.
pub const TERMS: [&str; 36] = [
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
    "spring elasticity",
    "tendon elasticity",
    "loads",
    "surface charges",
    "circuit sources",
    "following loads",
    "block viscosity",
    "muscle viscosity",
    "maxwell viscosity",
    "block maxwell viscosity",
    "circuit resistance",
    "joint damping",
    "spring damping",
    "rigid bodies",
    "joint directions",
    "joint points",
    "joint coordinates",
    "glue",
];

/// Place of a term in the sum.
pub(super) fn rank(term: &str) -> usize {
    let place = TERMS.iter().position(|name| *name == term);
    place.unwrap_or(TERMS.len())
}

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

/// Keeps the first reason for each term that is not there, in the order of the sum.
pub(super) fn settle(present: &[Present], left_out: &mut Vec<LeftOut>) {
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
