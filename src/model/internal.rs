//! Internal coordinates: numbers of an instant that belong to a part of the scene and are no places, with the value at a start.
//!
//! They have no mass. Each has an equation: a force that depends on it, or a constraint.

use crate::kinematics::MaterialVector;
use crate::model::variables::Size;

/// An internal coordinate.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Internal {
    /// Full name.
    pub(super) name: String,
    /// Typical size of its value.
    pub(super) size: Size,
    /// Joint of the condensed system of which it is the coordinate.
    pub(super) joint: usize,
}

/// The internal coordinates of a model in the making.
#[derive(Debug)]
pub(super) struct Internals {
    /// Number of the coordinates before them.
    first: usize,
    pub(super) list: Vec<Internal>,
}

impl Internals {
    /// None so far, behind `first` other coordinates.
    pub(super) const fn behind(first: usize) -> Self {
        Self {
            first,
            list: Vec::new(),
        }
    }

    /// Adds one; returns the vector that has it in its first component.
    pub(super) fn add(&mut self, internal: Internal) -> MaterialVector {
        self.list.push(internal);
        self.vector(self.list.len() - 1)
    }

    /// The vector that has an internal coordinate in its first component.
    pub(super) fn vector(&self, index: usize) -> MaterialVector {
        MaterialVector::coordinate(self.first + index)
    }
}
