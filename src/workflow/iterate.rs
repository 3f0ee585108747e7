//! An iterate of the solver of a control problem.

use std::fmt;

use crate::control::Solution;
use crate::ipopt::Iteration;
use crate::model::Model;

/// Gives the motions of an iterate by their numbers.
pub type IterateMotions<'a> = &'a dyn Fn(usize) -> Solution;

/// An iterate of the solver.
pub struct Iterate<'a> {
    /// Report of the solver on it.
    pub report: &'a Iteration,
    /// The models, one for each motion.
    pub models: &'a [&'a Model],
    /// Its motions.
    pub motions: IterateMotions<'a>,
    /// Report of the solver on the iterate before, and the motions of that one with their costates, with which a later solve goes on; where they
    /// are known.
    pub before: Option<(&'a Iteration, IterateMotions<'a>)>,
}

impl fmt::Debug for Iterate<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.report.fmt(f)
    }
}
