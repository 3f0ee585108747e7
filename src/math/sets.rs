//! Disjoint sets of numbers: the connected components of a graph.

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

#[cfg(test)]
mod tests {
    use crate::math::DisjointSets;
    use crate::math::Random;

    /// Against the reachability of every pair by repeated passes over the list of pairs.
    #[test]
    fn sets_are_what_is_reachable() {
        let mut random = Random::new(7);
        let (mut alone, mut together) = (0, 0);
        for _ in 0..50 {
            let n = 12;
            let mut draw = || (random.between(0.0, n as f64) as usize).min(n - 1);
            let pairs: Vec<(usize, usize)> = (0..6).map(|_| (draw(), draw())).collect();
            let mut sets = DisjointSets::new(n);
            for &(a, b) in &pairs {
                sets.join(a, b);
            }
            let found = sets.all();
            for i in 0..n {
                let mut reached = vec![false; n];
                reached[i] = true;
                for _ in 0..n {
                    for &(a, b) in &pairs {
                        let either = reached[a] || reached[b];
                        (reached[a], reached[b]) = (either, either);
                    }
                }
                let smallest = reached.iter().position(|&r| r);
                assert_eq!(Some(found[i]), smallest);
                match found[i] == i {
                    true => alone += 1,
                    false => together += 1,
                }
            }
        }
        assert!(alone > 100 && together > 100, "{alone} {together}");
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
