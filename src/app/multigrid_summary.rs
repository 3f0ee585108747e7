//! Counts of an iteration with multigrid in `summary.json`.

use serde::Serialize;

use crate::sparse::multigrid::MultigridReport;

/// An iteration with multigrid.
#[derive(Debug, Serialize)]
pub(super) struct MultigridCounts {
    /// Iterations of all linear systems.
    krylov_iterations: usize,
    /// Times that the coarse matrices were made.
    hierarchies: usize,
    /// Number of grids of the largest block.
    levels: usize,
    /// Memory of the grids in bytes.
    bytes: usize,
    /// Linear systems for which a direct solver took over.
    fallbacks: usize,
}

impl MultigridCounts {
    /// `None` where there was none.
    pub(super) fn new(report: MultigridReport, fallbacks: usize) -> Option<Self> {
        let MultigridReport {
            iterations,
            hierarchies,
            levels,
            bytes,
        } = report;
        (levels > 0).then_some(Self {
            krylov_iterations: iterations,
            hierarchies,
            levels,
            bytes,
            fallbacks,
        })
    }
}
