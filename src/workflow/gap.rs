//! Duality gap: a bound of the difference between an objective and its least value, which the barrier of the bounds leaves.
//!
//! A solver of interior points ends where the products of multipliers z with the distances d from their bounds are as small as the
//! tolerance asks for, not zero. Their sum Σ z d is the gap to the dual objective, which bounds what is lost where the problem is convex
//! near the optimum. The tolerance is relative to the size that the objective has at the guess: where the objective falls far below, as costs of a deviation
//! do that vanishes, the gap may be as large as the objective.

use crate::ipopt::SolverResult;
use crate::nlp::{Bounds, Nlp};

/// A gap as a part of the objective from which on a smaller tolerance is set, and a warning is given where it stays.
const PART: f64 = 0.01;
/// Scaled gaps below these are zero: one to make smaller, and one to report.
const NONE: f64 = 1e-10;
const UNTOLD: f64 = 1e-8;
/// No tolerance is smaller than this.
const LEAST: f64 = 1e-11;
/// A tolerance becomes smaller by these factors at once.
const FACTORS: [f64; 2] = [1e-4, 0.1];

/// The gap of a solution in the unit of its objective.
pub(crate) fn gap(program: &impl Nlp, solution: &SolverResult) -> f64 {
    let (variables, rows) = (program.variables(), program.constraints());
    let multipliers = &solution.costates;
    let of_variables = |i: usize, x: f64| {
        let low = product(multipliers.lower[i], x - variables.lower[i]);
        low + product(multipliers.upper[i], variables.upper[i] - x)
    };
    let of_rows = |i: usize, value: f64| {
        let y = multipliers.constraints[i];
        match y < 0.0 {
            true => product(-y, value - rows.lower[i]),
            false => product(y, rows.upper[i] - value),
        }
    };
    let is_inequality = |bounds: &Bounds, i: usize| bounds.lower[i] < bounds.upper[i];
    let x = solution.x.iter().enumerate();
    let x = x.filter(|&(i, _)| is_inequality(variables, i));
    let g = solution.constraints.iter().enumerate();
    let g = g.filter(|&(i, _)| is_inequality(rows, i));
    let of_variables: f64 = x.map(|(i, &x)| of_variables(i, x)).sum();
    of_variables + g.map(|(i, &value)| of_rows(i, value)).sum::<f64>()
}

/// A multiplier times the distance from its bound; nothing of a bound that is not there.
fn product(multiplier: f64, distance: f64) -> f64 {
    match distance.is_finite() {
        true => (multiplier * distance).abs(),
        false => 0.0,
    }
}

/// The tolerance with which the gap of a solution becomes small relative to its objective; none where it is small, or cannot become so.
pub(crate) fn tighter(program: &impl Nlp, solution: &SolverResult, tolerance: f64) -> Option<f64> {
    let gap = gap(program, solution);
    let wanted = PART * solution.objective.abs();
    let counts = gap > wanted && gap * program.objective_scale() > NONE;
    let factor = (0.5 * wanted / gap).clamp(FACTORS[0], FACTORS[1]);
    (counts && solution.status.is_solved())
        .then_some(factor * tolerance)
        .filter(|&tolerance| tolerance >= LEAST)
}

/// That an objective may lie well above its least value, where the gap says so.
pub(crate) fn warning(gap: f64, solution: &SolverResult, scale: f64) -> Option<String> {
    let objective = solution.objective;
    let counts = gap > PART * objective.abs() && gap * scale > UNTOLD;
    (counts && solution.status.is_solved()).then(|| {
        format!(
            "the objective {objective:.3e} may lie up to {gap:.1e} above its least value: the barrier of the bounds leaves that much at this \
             \"tolerance\"; a smaller one tells more"
        )
    })
}
