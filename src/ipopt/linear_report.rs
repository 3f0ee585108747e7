//! What the linear systems of a solve took.

use crate::ipopt::status::Status;
use crate::kkt::Statistics;

/// What the linear systems of a solve took.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LinearReport {
    /// Who solved them: `stages`, or a name that Ipopt knows.
    pub solver: String,
    /// What that did; known of `stages` alone.
    pub stages: Option<StagesReport>,
}

/// What the linear solver along the horizon did in a solve.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StagesReport {
    /// Patterns analysed: 1, or 0 where the pattern was that of the solve before.
    pub analyses: usize,
    /// Factorisations, solutions and their errors.
    pub statistics: Statistics,
    /// Why the last factorisation was left off in its midst, if it was.
    pub stopped: Option<Status>,
    /// Seconds in analyses.
    pub analysis: f64,
    /// Seconds in factorisations.
    pub factorisation: f64,
    /// Seconds in solutions.
    pub solution: f64,
}
