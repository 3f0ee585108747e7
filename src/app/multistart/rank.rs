//! Rank of a start among several of one problem.

use std::cmp::Ordering;

/// Rank of a start, the least first: optima that are held by the objective, other optima by the objective, ends without one by the violation,
/// and starts that left no point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Rank {
    class: usize,
    value: f64,
}

impl Rank {
    /// Of an optimum, whose goal is held or whose period comes back where it is asked for.
    pub(super) fn of_optimum(objective: f64, is_held: bool) -> Self {
        Self {
            class: usize::from(!is_held),
            value: objective,
        }
    }

    /// Of an end without an optimum and the greatest violation there, where there is a point.
    pub(super) fn of_end(infeasibility: Option<f64>) -> Self {
        Self {
            class: if infeasibility.is_some() { 2 } else { 3 },
            value: infeasibility.unwrap_or(0.0),
        }
    }

    /// Returns true if there is a point.
    pub(super) fn has_point(&self) -> bool {
        self.class < 3
    }

    /// Compares two.
    pub(super) fn compare(&self, other: &Self) -> Ordering {
        let by_class = self.class.cmp(&other.class);
        by_class.then(self.value.total_cmp(&other.value))
    }
}
