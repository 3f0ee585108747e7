//! State of rest: the unknowns of a step, and the charts behind which its turns are counted.

use std::ops::{Deref, DerefMut};

/// The unknowns of a step (see [`Variables`](crate::model::Variables)); as a slice they stand without the charts, behind which turns are
/// zero.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct RestState {
    pub(super) unknowns: Vec<f64>,
    pub(super) charts: Vec<f64>,
}

impl RestState {
    /// The charts, four numbers each.
    pub(super) fn charts(&self) -> &[f64] {
        &self.charts
    }
}

impl Deref for RestState {
    type Target = [f64];

    fn deref(&self) -> &[f64] {
        &self.unknowns
    }
}

impl DerefMut for RestState {
    fn deref_mut(&mut self) -> &mut [f64] {
        &mut self.unknowns
    }
}
