//! The solves of a program one after another: the first one, others with new charts of its rotations, others that confirm
//! the objective.

use crate::control::problem::Combined;
use crate::control::{BoundaryError, Carried, InitialGuess, Solution, Transcription};
use crate::dynamics::DiscreteTrajectory;
use crate::ipopt::{Iteration, Options, Reached, Solver, SolverResult, Start, StartingPoint};
use crate::model::Model;
use crate::nlp::joined::{Joined, SharedVariable};
use crate::nlp::{Multipliers, Status};
use crate::stop;
use crate::workflow::error::WorkflowError;
use crate::workflow::gap::Gap;
use crate::workflow::motion::{Iterate, solved};
use crate::workflow::optimum::Budget;
use crate::workflow::program::{ProgramMotion, Programs, joined, multipliers_of, states_of_rest};
use crate::workflow::remark::phase;
use std::ops::ControlFlow;

/// Maximum numbers of repeated solves with other charts of its rotations, and with the objective scaled by its size.
const CHARTS: usize = 4;
const CONFIRMING: usize = 8;

/// The program of one or several motions in a solver.
pub(super) struct Solves<'a, 'm> {
    pub(super) motions: &'m [ProgramMotion<'m>],
    pub(super) shared: &'a [SharedVariable],
    pub(super) combined: Combined,
    /// Options of the first solve.
    pub(super) options: Options,
    pub(super) budget: Budget,
    /// Function that sees every iterate.
    pub(super) observer: &'a mut dyn FnMut(&Iterate<'_>) -> ControlFlow<()>,
    pub(super) solver: Solver<Joined<Transcription<'m>>>,
}

impl Solves<'_, '_> {
    /// Solves from a point.
    pub(super) fn solve(&mut self, point: &StartingPoint) -> Result<SolverResult, WorkflowError> {
        let program = self.solver.program();
        let places = program.places().clone();
        let decoders: Vec<_> = program.parts().map(Transcription::decoder).collect();
        let models: Vec<&Model> = self.motions.iter().map(|motion| motion.model).collect();
        let observer = &mut *self.observer;
        let mut observe = |report: &Iteration, reached: &Reached<'_>| {
            let at = |number: usize, report: &Iteration, x: &[f64], whole: Option<&Multipliers>| {
                let decoder = &decoders[number];
                let costates =
                    whole.map(|whole| decoder.costates(&multipliers_of(&places, number, whole)));
                let discrete = decoder.decode(&places.values_of(number, x));
                Solution {
                    barrier: Some(report.mu),
                    ..solved(models[number], &discrete, costates)
                }
            };
            let motions = |number: usize| at(number, report, reached.x, None);
            let before = reached.before.as_ref();
            let earlier = before.map(|before| {
                move |number: usize| {
                    at(number, before.report, before.x, Some(&before.multipliers()))
                }
            });
            let earlier = earlier
                .as_ref()
                .map(|motions| motions as &dyn Fn(usize) -> Solution);
            observer(&Iterate {
                report,
                models: &models,
                motions: &motions,
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
            let Some(initial) = self.far(&solution).filter(|_| stop::reason().is_none()) else {
                break;
            };
            phase("solving again, from the state that the first solution reached");
            let each = self.motions.iter().zip(&initial);
            let program = each.map(|(motion, initial)| {
                let ProgramMotion {
                    task,
                    model,
                    boundary,
                } = *motion;
                let program = Transcription::of_any(model, boundary, task.control, initial)?;
                Ok::<_, BoundaryError>((task.name.to_owned(), program))
            });
            // What cannot be built in the time that is left leaves the solution as it is.
            let Ok(programs) = program.collect::<Result<Vec<_>, _>>() else {
                break;
            };
            let Ok(rest) = states_of_rest(self.motions, &programs) else {
                break;
            };
            let options = Options {
                max_seconds: self.budget.left(),
                start: Start::PRIMAL,
                ..self.options.clone()
            };
            let each = programs.iter().zip(&initial);
            let points = each.map(|((_, program), initial)| program.start(initial));
            let points: Vec<StartingPoint> = points.collect();
            let whole = Programs {
                programs,
                points,
                rest,
            };
            let (program, point) = joined(whole, self.shared, self.combined);
            self.solver = Solver::new(program, options);
            solution = self.solve(&point)?;
        }
        Ok(solution)
    }

    /// The motions with charts where the bodies are, where a rotation of one of them ends far from its chart.
    fn far(&self, solution: &SolverResult) -> Option<Vec<InitialGuess>> {
        let program = self.solver.program();
        let mut is_far = false;
        let each = self.motions.iter().zip(program.parts()).enumerate();
        let initial = each.map(|(number, (motion, part))| {
            let discrete = part.decode(&program.places().values_of(number, &solution.x));
            let far = recentred(motion.model, &discrete);
            is_far |= far.is_some();
            far.unwrap_or_else(|| InitialGuess {
                h: discrete.times[1],
                discrete,
                costates: None,
                carried: Carried::default(),
            })
        });
        let initial: Vec<InitialGuess> = initial.collect();
        is_far.then_some(initial)
    }

    /// Solves again, with the objective scaled by its own size, as long as more of it may be left to gain than a solution may leave.
    pub(super) fn confirm(
        &mut self,
        mut solution: SolverResult,
    ) -> Result<(SolverResult, Gap), WorkflowError> {
        let tolerance = self.options.tolerance;
        let mut gap = Gap::new(self.solver.program_mut(), &solution, tolerance);
        for _ in 0..CONFIRMING {
            let is_done = gap.is_closed() || !solution.status.is_stationary();
            let next = gap.next(&solution, &self.options);
            let next = next.filter(|_| !is_done && stop::reason().is_none());
            let Some(mut options) = next else {
                break;
            };
            phase("solving again, with the objective scaled by its size");
            options.max_seconds = self.budget.left();
            self.solver.set_options(options.clone());
            let again = self.solve(&solution.to_point())?;
            let program = self.solver.program_mut();
            let (status, objective) = (again.status, again.objective);
            // Rounding may keep a solve from its tolerance at a point that is better all the same.
            let is_as_good = status.is_stationary() || objective < solution.objective;
            let found = gap.after(program, (&solution, &again), &options);
            if !(status.is_optimal() || is_as_good && found.is_feasible) {
                break;
            }
            gap = found;
            tracing::info!(?status, objective, left = gap.left, "confirmation");
            let kept = match status {
                Status::Solved => status,
                _ => Status::Acceptable,
            };
            let again = SolverResult {
                status: kept,
                ..again
            };
            solution = one_of_both(solution, again);
            if !status.is_optimal() {
                break;
            }
        }
        tracing::info!(left = gap.left, "end");
        solution.status = gap.status(solution.status);
        Ok((solution, gap))
    }
}

/// A rotation that ends farther from its chart, in rad, is solved again with a chart where it ended.
const FAR: f64 = std::f64::consts::FRAC_PI_3;

/// The motion with charts where its bodies are, where it ends far from those that it has.
pub(crate) fn recentred(model: &Model, discrete: &DiscreteTrajectory) -> Option<InitialGuess> {
    let map = &model.action.map;
    let is_far = |z: &Vec<f64>| map.angle_from_charts(z) > FAR;
    discrete.z.iter().any(is_far).then(|| {
        let z = discrete.z.iter().map(|z| {
            let mut instant = map.placed(z);
            map.recentre(&mut instant);
            instant.z
        });
        InitialGuess {
            discrete: DiscreteTrajectory {
                z: z.collect(),
                ..discrete.clone()
            },
            h: discrete.times[1],
            costates: None,
            carried: Carried::default(),
        }
    })
}

/// The better of two solves, with the iterations, evaluations and seconds of both.
fn one_of_both(mut first: SolverResult, mut second: SolverResult) -> SolverResult {
    if second.status.is_solved() {
        put_before(&mut second, &first);
        return second;
    }
    put_after(&mut first, &second);
    first
}

/// Adds iterations, evaluations and seconds of an earlier solve.
pub(super) fn put_before(kept: &mut SolverResult, earlier: &SolverResult) {
    kept.iterations.splice(0..0, earlier.iterations.clone());
    add_calls(kept, earlier);
}

/// Adds iterations, evaluations and seconds of a later solve.
pub(super) fn put_after(kept: &mut SolverResult, later: &SolverResult) {
    kept.iterations.extend_from_slice(&later.iterations);
    add_calls(kept, later);
}

fn add_calls(kept: &mut SolverResult, other: &SolverResult) {
    kept.seconds += other.seconds;
    kept.evaluations += other.evaluations;
    kept.failed_evaluations += other.failed_evaluations;
}
