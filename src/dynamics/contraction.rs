//! How the updates of a Newton iteration shrink, and what follows from it: whether they converge, whether the tangent serves.

use crate::dynamics::solving::Newton;

/// Convergence: the error after a Newton update of relative size δ is of order δ².
const UPDATE: f64 = 1e-9;
/// Error, by the rate of the updates, that an iteration with a reused tangent leaves.
const LEFT: f64 = 1e-10;
/// A reused tangent that makes the updates shrink by less than this is factorised anew.
const SLOW: f64 = 0.75;
/// Updates of at least this relative size are far from the solution.
const FAR: f64 = 1e-3;

/// The updates of one iteration so far.
#[derive(Debug)]
pub(super) struct Contraction {
    newton: Newton,
    /// Relative size of the last update that was made.
    last: Option<f64>,
}

/// What an update is good for.
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
        Self { newton, last: None }
    }

    /// Judges an update by its relative size, whether its tangent is of an earlier point, and whether factors are approximate.
    pub(super) fn judge(&mut self, size: f64, is_reused: bool, is_approximate: bool) -> Verdict {
        // Newton's updates shrink quadratically, those of a reused tangent by a factor.
        // What a tangent of an earlier step does is not known before its second update.
        let rate = match self.last {
            Some(last) => size / last,
            None if is_reused || is_approximate => SLOW,
            None => 0.0,
        };
        if is_reused && rate >= 1.0 && size >= FAR {
            self.last = None;
            return Verdict::Astray;
        }
        let is_close = match self.newton {
            Newton::Full => size < UPDATE,
            Newton::Modified => size * (rate / (1.0 - rate)).max(size) < LEFT,
        };
        let is_first = self.last.replace(size).is_none();
        if is_close && (rate < 1.0 || size < UPDATE) {
            return Verdict::Converged;
        }
        match self.newton == Newton::Modified && (rate < SLOW || is_first) {
            true => Verdict::Shrinks,
            false => Verdict::Slow,
        }
    }
}
