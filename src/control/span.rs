//! Intervals of a horizon: those of the motion, and one that holds its goal.

/// Intervals of a horizon.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Span {
    /// Intervals of the motion: the instant at which it ends.
    pub end: usize,
    /// All intervals: those of the motion and, where the inputs that hold its goal are sought, one at rest behind them.
    pub intervals: usize,
    /// True if the last interval comes before the first one, of a periodic motion.
    pub is_closed: bool,
}

impl Span {
    /// The interval before interval k, where there is one.
    pub(super) fn before(self, k: usize) -> Option<usize> {
        let last = self.is_closed.then(|| self.intervals - 1);
        k.checked_sub(1).or(last)
    }
}
