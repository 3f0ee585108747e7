//! Plan of the action: the reasons why each term is present or absent.

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
