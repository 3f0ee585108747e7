//! The linear systems of a solve in `summary.json`.

use crate::ipopt::LinearReport;
use crate::sparse::multigrid::MultigridReport;
use serde::Serialize;

/// The linear systems of the solver.
#[derive(Debug, Serialize)]
pub(super) struct LinearSystems {
    /// `stages`, or the name of another one.
    name: String,
    #[serde(flatten)]
    stages: Option<Stages>,
}

/// Counts and times of the linear solver along the horizon.
#[derive(Debug, Serialize)]
struct Stages {
    factorisations: usize,
    solutions: usize,
    /// Pivots that were found later than expected.
    delays: usize,
    /// Factorisations of condensed systems, of few inputs for many states.
    condensed: usize,
    equilibrations: usize,
    /// Factorisations that were repeated under a stricter rule.
    repeated: usize,
    /// Greatest one of the factors that were used.
    backward_error: f64,
    analysis_seconds: f64,
    factorisation_seconds: f64,
    /// Of these in systems that were not condensed where others were.
    whole_seconds: f64,
    solution_seconds: f64,
}

impl LinearSystems {
    /// Of a solve.
    pub(super) fn new(report: &LinearReport) -> Self {
        let stages = report.stages.map(|stages| Stages {
            factorisations: stages.statistics.factorisations,
            solutions: stages.statistics.solutions,
            delays: stages.statistics.delays,
            condensed: stages.statistics.condensed,
            equilibrations: stages.statistics.equilibrations,
            repeated: stages.statistics.repeated,
            backward_error: stages.statistics.backward_error,
            analysis_seconds: stages.analysis,
            factorisation_seconds: stages.factorisation,
            whole_seconds: stages.whole,
            solution_seconds: stages.solution,
        });
        Self {
            name: report.solver.clone(),
            stages,
        }
    }
}

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
