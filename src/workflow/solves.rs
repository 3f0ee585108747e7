//! The solves of a program one after another: the first one, others with new charts of its rotations, others that make the distance of the objective
//! from its least value nearby small.
//!
//! A solver of interior points ends where the optimality conditions hold to a tolerance that is relative to the size of the objective at the guess.
//! Where the objective falls far below that, the tolerance may be as large as the objective. With the multipliers z of bounds at the distances d, y of
//! rows that miss their bounds by c, and the gradient r of the Lagrangian, the bound
//!
//! ```text
//! f − f* ≤ Σ z d + Σ |y c| + Σ |r|   to first order, where no variable changes by more than its scale
//! ```
//!
//! tells whether it is so. Then the program is solved again from there, with the objective scaled by its own size, or by what may be left of it where
//! that is more. Where the bound is wide all the same, as with many bounds that are not reached, two solves decide between which the barrier
//! parameter falls by ten or more: f is linear in it near the end, so that what is left is less than what the second one gained. Where rounding
//! ends a solve at a search direction that is too small, that direction bounds the change of each variable in place of its scale.

use crate::control::problem::ControlTask;
use crate::control::{BoundaryError, InitialGuess, Solution, Transcription};
use crate::dynamics::DiscreteTrajectory;
use crate::ipopt::{Iteration, Options, Reached, Solver, SolverResult, Start, StartingPoint};
use crate::model::Model;
use crate::nlp::joined::Joined;
use crate::nlp::{Bounds, Multipliers, Nlp, Status, slopes};
use crate::stop;
use crate::workflow::error::WorkflowError;
use crate::workflow::motion::{Iterate, solved};
use crate::workflow::program::{ProgramMotion, joined, multipliers_of};
use crate::workflow::remark::phase;
use std::ops::ControlFlow;

/// Maximum numbers of repeated solves with other charts of its rotations, and with the objective scaled by its size.
const CHARTS: usize = 4;
const CONFIRMING: usize = 8;

/// The program of one or several motions in a solver.
pub(super) struct Solves<'a, 'm> {
    pub(super) motions: &'m [ProgramMotion<'m>],
    pub(super) task: &'a ControlTask<'a>,
    /// Options of the first solve.
    pub(super) options: Options,
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
                move |number: usize| at(number, before.report, before.x, Some(before.multipliers))
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
            let parts = each.map(|(motion, initial)| {
                let (model, boundary, task) = (motion.model, motion.boundary, motion.task);
                let program = Transcription::of_any(model, boundary, task.control, initial)?;
                let point = program.start(initial);
                Ok::<_, BoundaryError>((program, point))
            });
            // What cannot be built in the time that is left leaves the solution as it is.
            let Ok(parts) = parts.collect::<Result<Vec<_>, _>>() else {
                break;
            };
            let Ok((program, point)) = joined(self.motions, parts, self.task) else {
                break;
            };
            let options = Options {
                start: Start::PRIMAL,
                ..self.options.clone()
            };
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
            far.unwrap_or_else(|| guess(discrete))
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
            let Some(options) = next else {
                break;
            };
            phase("solving again, with the objective scaled by its size");
            self.solver.set_options(options.clone());
            let again = self.solve(&solution.to_point())?;
            let program = self.solver.program_mut();
            let (status, objective) = (again.status, again.objective);
            // Rounding may keep a solve from its tolerance at a point that is better all the same.
            let is_as_good = status.is_stationary() || objective < solution.objective;
            let found = gap.after(program, [&solution, &again], &options);
            if !(status.is_optimal() || is_as_good && found.is_feasible) {
                break;
            }
            gap = found;
            tracing::info!(?status, objective, left = gap.left, "confirmation");
            let mut again = SolverResult {
                status: match status {
                    Status::Solved => status,
                    _ => Status::Acceptable,
                },
                ..again
            };
            put_before(&mut again, &solution);
            solution = again;
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
    let is_far = |z: &Vec<f64>| map.tree.angle_from_charts(z) > FAR;
    discrete.z.iter().any(is_far).then(|| {
        let z = discrete.z.iter().map(|z| {
            let mut instant = map.placed(z);
            map.recentre(&mut instant);
            instant.z
        });
        guess(DiscreteTrajectory {
            z: z.collect(),
            ..discrete.clone()
        })
    })
}

/// A guess of a motion as it is.
fn guess(discrete: DiscreteTrajectory) -> InitialGuess {
    let h = discrete.times[1];
    InitialGuess::of_motion(discrete, h)
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

/// The objective of a solution is this part of itself above its least value at most, unless a larger tolerance is asked for.
const PART: f64 = 1e-6;
/// Part of the size that the guess gives the objective which counts as zero.
const ZERO: f64 = 1e-15;
/// No tolerance is smaller than this.
const LEAST: f64 = 1e-14;
/// Factor of a tolerance that was too large.
const SMALLER: f64 = 1e-2;
/// Ipopt ends at steps below this part of all variables.
const TINY_STEP: f64 = 10.0 * f64::EPSILON;
/// Fall of the barrier parameter between two solves after which what the second one gained bounds what is left.
const FALL: f64 = 10.0;

/// Distance of an objective from its least value, with the scale and the tolerance of the solve that found it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Gap {
    /// The objective lies no farther above its least value nearby, in its unit.
    pub(crate) left: f64,
    /// True unless the last step needed more curvature than the Lagrangian has along the equations: its matrix had another inertia than at a minimum.
    is_minimum: bool,
    /// True if the rows hold to the tolerance of the program.
    pub(crate) is_feasible: bool,
    /// Violation of the rows that is allowed.
    allowed: f64,
    objective: f64,
    /// Part of the objective that may be left.
    part: f64,
    /// Objective that counts as zero.
    zero: f64,
    scale: f64,
    tolerance: f64,
}

impl Gap {
    /// The gap of the solution of a program to a tolerance.
    pub(crate) fn new(program: &mut impl Nlp, solution: &SolverResult, tolerance: f64) -> Self {
        let scale = program.objective_scale();
        let last = solution.iterations.last();
        let violation = program.constraints().violation(&solution.constraints);
        Self {
            left: bound(program, solution),
            is_minimum: last.is_none_or(|last| last.regularization <= 0.0),
            is_feasible: violation <= tolerance,
            allowed: tolerance,
            objective: solution.objective.abs(),
            part: PART.max(tolerance),
            zero: ZERO / scale,
            scale,
            tolerance,
        }
    }

    /// Returns true if so little is left that the objective is the least one.
    pub(crate) fn is_closed(&self) -> bool {
        self.left <= self.zero.max(self.part * self.objective)
    }

    /// Options of a solve from a solution that leaves less; none where no smaller tolerance can be met.
    pub(crate) fn next(&self, solution: &SolverResult, options: &Options) -> Option<Options> {
        let size = self.objective.max(self.left.min(self.scale.recip()));
        let own = size.max(self.zero).recip();
        let tolerance = match own > self.scale / SMALLER {
            true => self.tolerance,
            false => self.tolerance * SMALLER,
        };
        let scale = own.max(self.scale);
        let mu = solution.iterations.last()?.mu;
        (tolerance >= LEAST).then(|| Options {
            tolerance,
            objective_scale: Some(scale),
            start: Start::Resumed {
                mu_init: (mu * scale / self.scale).min(0.1),
            },
            ..options.clone()
        })
    }

    /// The gap after a solve with these options, `before` which there was another solution.
    pub(crate) fn after(
        &self,
        program: &mut impl Nlp,
        [before, solution]: [&SolverResult; 2],
        options: &Options,
    ) -> Self {
        let scale = options.objective_scale.unwrap_or(self.scale);
        let barrier =
            |of: &SolverResult, scale: f64| of.iterations.last().map(|last| last.mu / scale);
        let falls = barrier(before, self.scale).zip(barrier(solution, scale));
        let gained = match falls.is_some_and(|(before, after)| before >= FALL * after) {
            true => (before.objective - solution.objective).abs(),
            false => f64::INFINITY,
        };
        let own = Self::new(program, solution, self.allowed);
        Self {
            left: own.left.min(gained),
            scale,
            tolerance: options.tolerance,
            ..own
        }
    }

    /// The status of a solution with this gap: what is not known to be the least objective is acceptable. Rounding may keep a solver from its
    /// tolerance where the objective is the least one all the same.
    pub(crate) fn status(&self, found: Status) -> Status {
        match found.is_stationary() {
            true if !self.is_feasible => found,
            true if self.is_closed() => Status::Solved,
            true => Status::Acceptable,
            false => found,
        }
    }

    /// That an objective may lie above its least value, where it does.
    pub(crate) fn warning(&self, solution: &SolverResult) -> Option<String> {
        let is_optimal = solution.status.is_optimal();
        let objective = solution.objective;
        let stationary = (is_optimal && !self.is_minimum).then(|| {
            "a stationary point that is not known to be a minimum: the objective falls along some motions to second order".to_owned()
        });
        let is_wide = is_optimal && !self.is_closed();
        stationary.or_else(|| is_wide.then(|| {
            format!(
                "the objective {objective:.6e} may lie up to {:.1e} above the least one nearby: no solve to a smaller tolerance confirmed it",
                self.left
            )
        }))
    }
}

/// A bound of what the objective of a solution lies above its least value, to first order.
pub(crate) fn bound(program: &mut impl Nlp, solution: &SolverResult) -> f64 {
    let SolverResult { x, costates, .. } = solution;
    let jacobian = program.jacobian_structure();
    let slopes = slopes(program, &jacobian, 1.0, x, &costates.constraints);
    let Bounds { lower, upper } = program.variables();
    // Newton's step of a search direction that is too small is this part of a variable and its scale.
    let step = |x: f64| match solution.status {
        Status::SearchDirectionTooSmall => TINY_STEP * (1.0 + x.abs()),
        _ => 1.0,
    };
    let of_variable = |i: usize| {
        let slope = slopes[i] - costates.lower[i] + costates.upper[i];
        let of_bounds = product(costates.lower[i], x[i] - lower[i])
            + product(costates.upper[i], upper[i] - x[i]);
        match lower[i] < upper[i] {
            true => slope.abs() * step(x[i]) + of_bounds,
            false => 0.0,
        }
    };
    let Bounds { lower, upper } = program.constraints();
    let of_row = |i: usize| {
        let (y, value) = (costates.constraints[i], solution.constraints[i]);
        let to_bound = [value - lower[i], upper[i] - value];
        product(y, to_bound[usize::from(y >= 0.0)])
    };
    let of_variables: f64 = (0..x.len()).map(of_variable).sum();
    let rows = 0..solution.constraints.len();
    of_variables + rows.map(of_row).sum::<f64>()
}

/// The size of a multiplier times the distance from its bound; nothing of a bound that is not there.
fn product(multiplier: f64, distance: f64) -> f64 {
    match distance.is_finite() {
        true => (multiplier * distance).abs(),
        false => 0.0,
    }
}
