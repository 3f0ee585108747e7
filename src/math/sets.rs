//! Disjoint sets of numbers: the connected components of a graph.
//!
//! Numbers of entries, and requests to stop, of all that works on graphs.

/// A partition of 0, …, n − 1 into sets that are joined; each is named by its smallest number.
///
/// Galler and Fischer, An improved equivalence algorithm, CACM 7 (1964), with paths halved on the way.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DisjointSets {
    /// A smaller number of the same set, or the number itself.
    lower: Vec<usize>,
}

impl DisjointSets {
    /// `count` numbers, each alone.
    pub fn new(count: usize) -> Self {
        Self {
            lower: (0..count).collect(),
        }
    }

    /// The smallest number of the set of a number.
    pub fn smallest(&mut self, mut number: usize) -> usize {
        while self.lower[number] != number {
            self.lower[number] = self.lower[self.lower[number]];
            number = self.lower[number];
        }
        number
    }

    /// Joins the sets of two numbers.
    pub fn join(&mut self, a: usize, b: usize) {
        let (a, b) = (self.smallest(a), self.smallest(b));
        self.lower[a.max(b)] = a.min(b);
    }

    /// The smallest number of the set of each number.
    pub fn all(mut self) -> Vec<usize> {
        (0..self.lower.len()).map(|i| self.smallest(i)).collect()
    }
}

/// The work has no result, because it was time to stop.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("stopped before the end")]
pub struct Stopped;

/// Callback that returns true when work is to stop; called on any thread.
pub type IsOver<'a> = &'a (dyn Fn() -> bool + Sync);

/// A number of which large meshes have tens of millions.
///
/// # Panics
/// It is too large for that.
pub(crate) fn compact_index(i: usize) -> u32 {
    u32::try_from(i).expect("entries can be counted")
}

#[cfg(test)]
#[path = "../../tests/units/math/sets.rs"]
mod tests;
