//! Distance of an objective from its least value nearby, and the solves that make it small.
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

use crate::ipopt::{Options, SolverResult, Start};
use crate::nlp::{Bounds, Nlp, Status};

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
        let zero = ZERO / scale;
        Self {
            left: bound(program, solution),
            is_minimum: is_minimum(solution),
            is_feasible: is_feasible(program, solution, tolerance),
            allowed: tolerance,
            objective: solution.objective.abs(),
            part: PART.max(tolerance),
            zero,
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
        (before, solution): (&SolverResult, &SolverResult),
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
        Self {
            left: bound(program, solution).min(gained),
            is_minimum: is_minimum(solution),
            is_feasible: is_feasible(program, solution, self.allowed),
            objective: solution.objective.abs(),
            scale,
            tolerance: options.tolerance,
            ..*self
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

/// Returns true if the last step towards a solution needed no regularisation.
fn is_minimum(solution: &SolverResult) -> bool {
    let last = solution.iterations.last();
    last.is_none_or(|last| last.regularization <= 0.0)
}

/// Returns true if a point keeps the rows to a tolerance.
fn is_feasible(program: &impl Nlp, solution: &SolverResult, tolerance: f64) -> bool {
    let violation = program.constraints().violation(&solution.constraints);
    violation <= tolerance
}

/// A bound of what the objective of a solution lies above its least value, to first order.
pub(crate) fn bound(program: &mut impl Nlp, solution: &SolverResult) -> f64 {
    let SolverResult { x, costates, .. } = solution;
    let mut slopes = vec![0.0; x.len()];
    program.gradient(x, &mut slopes);
    let entries = program.jacobian_structure();
    let mut values = vec![0.0; entries.rows.len()];
    program.jacobian(x, &mut values);
    for ((&row, &col), value) in entries.rows.iter().zip(&entries.cols).zip(&values) {
        slopes[col as usize] += value * costates.constraints[row as usize];
    }
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
    let of_row = |(i, value): (usize, &f64)| {
        let y = costates.constraints[i];
        product(
            y,
            if y < 0.0 {
                value - lower[i]
            } else {
                upper[i] - value
            },
        )
    };
    let of_variables: f64 = (0..x.len()).map(of_variable).sum();
    of_variables
        + solution
            .constraints
            .iter()
            .enumerate()
            .map(of_row)
            .sum::<f64>()
}

/// The size of a multiplier times the distance from its bound; nothing of a bound that is not there.
fn product(multiplier: f64, distance: f64) -> f64 {
    match distance.is_finite() {
        true => (multiplier * distance).abs(),
        false => 0.0,
    }
}
