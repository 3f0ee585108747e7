//! Parts of a URDF file that have no place in a scene.

use std::collections::BTreeMap;
use std::fmt;

/// Parts of a file that are left out, by their kinds, each with its owners.
#[derive(Debug, Default)]
pub(super) struct LeftOut(BTreeMap<String, Vec<String>>);

impl LeftOut {
    /// Adds a part of an owner.
    pub(super) fn add(&mut self, kind: impl Into<String>, owner: impl fmt::Display) {
        let owners = self.0.entry(kind.into()).or_default();
        let owner = owner.to_string();
        if !owners.contains(&owner) {
            owners.push(owner);
        }
    }

    /// A sentence for each kind.
    pub(super) fn notes(&self) -> impl Iterator<Item = String> + '_ {
        let note = |(kind, owners): (&String, &Vec<String>)| {
            format!("left out: {kind} of {}", owners.join(", "))
        };
        self.0.iter().map(note)
    }
}
