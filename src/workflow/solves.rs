//! The solves of a program one after another: the first one, others with new charts of its rotations, others to a smaller tolerance.

use std::ops::ControlFlow;
use std::time::Instant;

use crate::control::problem::Control;
use crate::control::{BoundaryConditions, Costates, Solution, Transcription};
use crate::ipopt::{
    Iteration, Options, Reached, Solver, SolverResult, Start, StartingPoint, interrupt,
};
use crate::model::Model;
use crate::workflow::combined::one_of_both;
use crate::workflow::error::WorkflowError;
use crate::workflow::gap;
use crate::workflow::iterate::Iterate;
use crate::workflow::motion::solved;
use crate::workflow::optimum::seconds_left;
use crate::workflow::phase::phase;
use crate::workflow::recentre::recentred;

/// Maximum numbers of repeated solves with other charts of its rotations, and to a smaller tolerance.
const CHARTS: usize = 4;
const TIGHTENED: usize = 3;
/// Iterations of a solve to a smaller tolerance.
const AGAIN: usize = 100;

/// A control problem with its program in a solver.
pub(super) struct Solves<'a, 'm> {
    pub(super) model: &'m Model,
    pub(super) boundary: &'a BoundaryConditions,
    pub(super) control: &'a Control,
    /// Options of the first solve.
    pub(super) options: Options,
    /// The time from which on seconds count, and how many there are.
    pub(super) began: Instant,
    pub(super) seconds: Option<f64>,
    /// Function that sees every iterate.
    pub(super) observer: &'a mut dyn FnMut(&Iterate<'_>) -> ControlFlow<()>,
    pub(super) solver: Solver<Transcription<'m>>,
}

impl Solves<'_, '_> {
    /// Solves from a point.
    pub(super) fn solve(&mut self, point: &StartingPoint) -> Result<SolverResult, WorkflowError> {
        let model = self.model;
        let decoder = self.solver.program().decoder();
        let observer = &mut *self.observer;
        let mut observe = |report: &Iteration, reached: &Reached<'_>| {
            let at = |report: &Iteration, x: &[f64], costates: Option<Costates>| Solution {
                barrier: Some(report.mu),
                ..solved(model, &decoder.decode(x), costates)
            };
            let motion = || at(report, reached.x, None);
            let before = reached.before.as_ref();
            let earlier = before.map(|before| {
                let costates = || decoder.costates(&before.multipliers());
                move || at(before.report, before.x, Some(costates()))
            });
            let earlier = earlier
                .as_ref()
                .map(|motion| motion as &dyn Fn() -> Solution);
            observer(&Iterate {
                report,
                model,
                motion: &motion,
                before: before.map(|before| before.report).zip(earlier),
            })
        };
        let found = self.solver.solve(point, &mut observe);
        found.cloned().map_err(|error| WorkflowError::ipopt(&error))
    }

    /// Solves again with charts where the bodies are, as long as a rotation ends far from its chart.
    pub(super) fn recentre(
        &mut self,
        mut solution: SolverResult,
    ) -> Result<SolverResult, WorkflowError> {
        for _ in 0..CHARTS {
            let far = recentred(self.model, &self.solver.program().decode(&solution.x));
            let Some(initial) = far.filter(|_| interrupt::stop().is_none()) else {
                break;
            };
            phase("solving again, from the state that the first solution reached");
            let program = Transcription::of_any(self.model, self.boundary, self.control, &initial);
            // What cannot be built in the time that is left leaves the solution as it is.
            let Ok(program) = program else {
                break;
            };
            let options = Options {
                max_seconds: self.left(),
                start: Start::PRIMAL,
                ..self.options.clone()
            };
            let point = program.start(&initial);
            self.solver = Solver::new(program, options);
            solution = self.solve(&point)?;
        }
        Ok(solution)
    }

    /// Solves again to a smaller tolerance, as long as the duality gap is wide.
    pub(super) fn tighten(
        &mut self,
        mut solution: SolverResult,
    ) -> Result<SolverResult, WorkflowError> {
        let mut tolerance = self.options.tolerance;
        for _ in 0..TIGHTENED {
            let tighter = gap::tighter(self.solver.program(), &solution, tolerance);
            let Some(tighter) = tighter.filter(|_| interrupt::stop().is_none()) else {
                break;
            };
            phase("solving again, to a smaller tolerance");
            tolerance = tighter;
            let mu_init = solution.iterations.last().map_or(1e-9, |last| last.mu);
            self.solver.set_options(Options {
                tolerance,
                max_iterations: self.options.max_iterations.min(AGAIN),
                max_seconds: self.left(),
                start: Start::Resumed { mu_init },
                ..self.options.clone()
            });
            let again = self.solve(&solution.to_point())?;
            let failed = !again.status.is_solved();
            solution = one_of_both(solution, again);
            if failed {
                break;
            }
        }
        Ok(solution)
    }

    /// Seconds that are left.
    fn left(&self) -> Option<f64> {
        seconds_left(self.seconds, self.began)
    }
}
