//! Report of the steps of a simulation: their counts and times.

use crate::sparse::multigrid::MultigridReport;

/// Counts and times of the steps.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StepperReport {
    /// Steps taken, halved ones included.
    pub steps: usize,
    /// Newton iterations.
    pub iterations: usize,
    /// Steps that had to be halved.
    pub halved: usize,
    /// Factorisations of the tangent.
    pub factorisations: usize,
    /// Seconds in the rows and the tangent.
    pub assembly: f64,
    /// Seconds in factorisations.
    pub factorisation: f64,
    /// Seconds in solutions with them.
    pub solution: f64,
    /// Systems for which a direct solver took over from an iteration.
    pub fallbacks: usize,
    /// Counts of the iterations with multigrid.
    pub multigrid: MultigridReport,
    /// Energy in mJ that the steps made, or lost where negative, where the method has a balance of energy.
    pub made: f64,
    /// Greatest energy in mJ that one step exchanged.
    pub exchanged: f64,
}
