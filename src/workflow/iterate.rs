//! An iterate of the solver of a control problem.

use std::fmt;

use crate::control::Solution;
use crate::ipopt::Iteration;
use crate::model::Model;

/// An iterate of the solver.
pub struct Iterate<'a> {
    /// Report of the solver on it.
    pub report: &'a Iteration,
    /// The model.
    pub model: &'a Model,
    /// Its motion.
    pub motion: &'a dyn Fn() -> Solution,
    /// Report of the solver on the iterate before, and that one with its costates, with which a later solve goes on; where they are known.
    pub before: Option<(&'a Iteration, &'a dyn Fn() -> Solution)>,
}

impl fmt::Debug for Iterate<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.report.fmt(f)
    }
}
