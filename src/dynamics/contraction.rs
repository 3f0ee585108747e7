//! Contraction of a Newton iteration: the decay of its updates, and the verdict on convergence and on the tangent.

use crate::dynamics::solving::Newton;

/// Convergence: the error after a Newton update of relative size δ is of order δ².
const UPDATE: f64 = 1e-9;
/// Error, by the rate of the updates, that an iteration with a reused tangent leaves.
const LEFT: f64 = 1e-10;
/// A reused tangent that makes the updates shrink by less than this is factorised anew.
const SLOW: f64 = 0.75;
/// The same of a tangent that is not factorised, as `benches/multigrid.rs` measures.
const CHEAP: f64 = 0.3;
/// Updates of at least this relative size are far from the solution.
const FAR: f64 = 1e-3;

/// The updates of one iteration so far.
#[derive(Debug)]
pub(super) struct Contraction {
    newton: Newton,
    /// Rate of the updates above which a tangent is made anew.
    slow: f64,
    /// Least rate that is believed: solutions by an iteration are as accurate as asked for, which one small ratio does not show.
    least: f64,
    /// Relative size of the last update that was made.
    last: Option<f64>,
    /// Ratio of that update to the one before, both by the tangent that is kept; zero where there are no two.
    rate_before: f64,
}

/// Verdict on an update.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Verdict {
    /// It is to be made, and is the last one.
    Converged,
    /// It is to be made, and the tangent serves for the next one.
    Shrinks,
    /// It is to be made, and the next one needs a new tangent.
    Slow,
    /// It is not to be made: an old tangent leads away from the solution.
    Astray,
}

impl Contraction {
    /// Before the first update.
    pub(super) const fn new(newton: Newton) -> Self {
        Self {
            newton,
            slow: SLOW,
            least: 0.0,
            last: None,
            rate_before: 0.0,
        }
    }

    /// The same where a new tangent costs no more than a few updates.
    pub(super) const fn of_cheap_tangents(newton: Newton) -> Self {
        Self {
            slow: CHEAP,
            least: CHEAP,
            ..Self::new(newton)
        }
    }

    /// Judges an update by its relative size, the age of its tangent, and the accuracy of the factors.
    pub(super) fn judge(&mut self, size: f64, is_reused: bool, is_approximate: bool) -> Verdict {
        // Newton's updates shrink quadratically, those of a reused tangent by a factor.
        // What a tangent of an earlier step does is not known before its second update.
        let rate = match self.last {
            Some(last) => size / last,
            None if is_reused || is_approximate => SLOW,
            None => 0.0,
        };
        let is_ratio = is_reused && self.last.is_some();
        let before = std::mem::replace(&mut self.rate_before, if is_ratio { rate } else { 0.0 });
        if is_reused && rate >= 1.0 && size >= FAR {
            self.last = None;
            return Verdict::Astray;
        }
        let is_close = match self.newton {
            Newton::Full => size < UPDATE,
            Newton::Modified => {
                // Combinations of updates with earlier ones make one small ratio now and then.
                let before = if is_reused { before } else { 0.0 };
                let rate = rate.max(before).max(self.least);
                size * (rate / (1.0 - rate)).max(size) < LEFT
            }
        };
        let is_first = self.last.replace(size).is_none();
        if is_close && (rate < 1.0 || size < UPDATE) {
            return Verdict::Converged;
        }
        match self.newton == Newton::Modified && (rate < self.slow || is_first) {
            true => Verdict::Shrinks,
            false => Verdict::Slow,
        }
    }
}

#[cfg(test)]
#[path = "../../tests/units/dynamics/contraction.rs"]
mod tests;
