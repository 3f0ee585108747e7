//! A point that the solver of a control problem has come to.

use std::fmt;

use crate::control::Solution;
use crate::ipopt::Iteration;
use crate::model::Model;

/// A point that the solver has come to.
pub struct Iterate<'a> {
    /// What the solver tells of it.
    pub report: &'a Iteration,
    /// The model.
    pub model: &'a Model,
    /// Its motion.
    pub motion: &'a dyn Fn() -> Solution,
    /// What the solver told of the point before, and that one with its costates, with which a later solve goes on; where they are known.
    pub before: Option<(&'a Iteration, &'a dyn Fn() -> Solution)>,
}

impl fmt::Debug for Iterate<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.report.fmt(f)
    }
}
