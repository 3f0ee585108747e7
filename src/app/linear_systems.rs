//! The evaluations and the linear systems of a solve in `summary.json`.

use crate::files::Entries;
use crate::ipopt::{LinearReport, SolverResult};
use crate::sparse::multigrid::MultigridReport;

/// Number of evaluations of each quantity by the solver.
pub(super) fn evaluations(solution: &SolverResult) -> Entries {
    let counts = &solution.evaluations;
    Entries::default()
        .with("objective", counts.objective)
        .with("gradient", counts.gradient)
        .with("constraints", counts.constraints)
        .with("jacobian", counts.jacobian)
        .with("hessian", counts.hessian)
}

/// Mean time in µs of one evaluation per interval; nothing where there was none.
pub(super) fn microseconds(solution: &SolverResult, intervals: usize) -> Entries {
    let (seconds, counts) = (&solution.seconds, &solution.evaluations);
    let mean = |seconds: f64, evaluations: usize| {
        (evaluations > 0).then(|| 1e6 * seconds / (evaluations * intervals) as f64)
    };
    Entries::default()
        .with("jacobian", mean(seconds.jacobian, counts.jacobian))
        .with("hessian", mean(seconds.hessian, counts.hessian))
}

/// Solver of the linear systems, with counts and times of that along the horizon.
pub(super) fn linear_systems(report: &LinearReport) -> Entries {
    let solver = Entries::default().with("name", &report.solver);
    let Some(stages) = &report.stages else {
        return solver;
    };
    let counts = &stages.statistics;
    solver
        .with("factorisations", counts.factorisations)
        .with("solutions", counts.solutions)
        // Pivots that were found later than expected.
        .with("delays", counts.delays)
        // Factorisations of condensed systems, of few inputs for many states.
        .with("condensed", counts.condensed)
        .with("equilibrations", counts.equilibrations)
        // Factorisations that were repeated under a stricter rule.
        .with("repeated", counts.repeated)
        // Greatest one of the factors that were used.
        .with("backward_error", counts.backward_error)
        .with("analysis_seconds", stages.analysis)
        .with("factorisation_seconds", stages.factorisation)
        // Of these in systems that were not condensed where others were.
        .with("whole_seconds", stages.whole)
        .with("solution_seconds", stages.solution)
}

/// Counts of an iteration with multigrid; `fallbacks` are linear systems for which a direct solver took over. None where there was none.
pub(super) fn multigrid(report: MultigridReport, fallbacks: usize) -> Option<Entries> {
    (report.levels > 0).then(|| {
        Entries::default()
            .with("krylov_iterations", report.iterations)
            // Times that the coarse matrices were made.
            .with("hierarchies", report.hierarchies)
            // Number of grids of the largest block.
            .with("levels", report.levels)
            // Memory of the grids.
            .with("bytes", report.bytes)
            .with("fallbacks", fallbacks)
    })
}
