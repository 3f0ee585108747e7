//! A start from another grid, moved to the path that the solver follows.
//!
//! At the barrier parameter μ the multiplier of a bound at distance s is μ/s. An optimum of another grid lies on bounds that are
//! others here, and a variable on a bound leaves it slowly. So every bounded variable is
//! moved by itself, with all others and the multipliers of the constraints held. Its Lagrangian has the slope r and the
//! curvature c; on the path
//!
//! ```text
//! (r + c (s − s₀)) s = μ   towards the nearer bound, where r pushes,
//! ```
//!
//! whose positive root is the new distance. The parameter is the mean complementarity r (x − bound) of the point as it came, within
//! a range.

use crate::ipopt::evaluation::Structures;
use crate::nlp::{Bounds, Multipliers, Nlp};

/// Range of the barrier parameter.
///
/// Iterations of seventeen starts on other grids and one of another duration, trunks and pairs: 216; not centred 365, cold 406.
const RANGE: [f64; 2] = [1e-4, 3e-4];
/// Least curvature: a variable in which the Lagrangian is flat, as the square of a voltage ([`Nlp::squares`]), goes no farther than the middle of
/// its bounds. With 1 the starts above take 200 iterations, one of them to a worse optimum.
const FLAT: f64 = 1e-8;
/// Least distance from a bound.
const LEAST: f64 = 1e-14;

/// Moves the bounded variables and the multipliers of their bounds to the barrier's path; multipliers are of the scaled objective.
/// Moves nothing where a derivative does not exist.
pub(super) fn centre(
    nlp: &mut dyn Nlp,
    structures: &Structures,
    scale: f64,
    (x, costates): (&mut [f64], &mut Multipliers),
) {
    let (slope, curvature) = slopes(nlp, structures, scale, x, &costates.constraints);
    let is_known = |list: &[f64]| list.iter().all(|v| v.is_finite());
    if !is_known(&slope) || !is_known(&curvature) {
        return;
    }
    let bounds = nlp.variables();
    let mu = complementarity(bounds, x, &slope).clamp(RANGE[0], RANGE[1]);
    let Bounds { lower, upper } = bounds;
    for i in 0..x.len() {
        let (low, high) = (lower[i], upper[i]);
        let is_free = low.is_infinite() && high.is_infinite();
        if is_free || low == high {
            continue;
        }
        let half = 0.5 * (high - low);
        let is_low_near = x[i] - low <= high - x[i];
        let (gap, push) = match is_low_near {
            true => (x[i] - low, slope[i]),
            false => (high - x[i], -slope[i]),
        };
        let c = curvature[i].abs().max(FLAT);
        let s = distance(gap.max(0.0), push.max(0.0), c, mu).clamp(LEAST, half);
        x[i] = if is_low_near { low + s } else { high - s };
        // No distance from a bound that is infinite: no multiplier.
        costates.lower[i] = mu / (x[i] - low).max(LEAST);
        costates.upper[i] = mu / (high - x[i]).max(LEAST);
    }
}

/// Mean over all bounds of the distance times the slope that pushes towards it; 0 without bounds.
fn complementarity(bounds: &Bounds, x: &[f64], slope: &[f64]) -> f64 {
    let (mut sum, mut count) = (0.0, 0);
    for (i, (x, r)) in x.iter().zip(slope).enumerate() {
        let (low, high) = (bounds.lower[i], bounds.upper[i]);
        if low == high {
            continue;
        }
        for (gap, push) in [(x - low, *r), (high - x, -r)] {
            if gap.is_finite() {
                sum += gap.max(0.0) * push.max(0.0);
                count += 1;
            }
        }
    }
    sum / f64::from(count.max(1))
}

/// The positive root s of (r + c (s − gap)) s = μ, by the form that does not cancel.
fn distance(gap: f64, r: f64, c: f64, mu: f64) -> f64 {
    let b = r - c * gap;
    let root = (b * b + 4.0 * c * mu).sqrt();
    match b > 0.0 {
        true => 2.0 * mu / (b + root),
        false => (root - b) / (2.0 * c),
    }
}

/// First and second derivatives of f + Σ yᵢ gᵢ by each variable, f scaled.
fn slopes(
    nlp: &mut dyn Nlp,
    structures: &Structures,
    scale: f64,
    x: &[f64],
    y: &[f64],
) -> (Vec<f64>, Vec<f64>) {
    let Structures { jacobian, hessian } = structures;
    let mut slope = vec![0.0; x.len()];
    nlp.gradient(x, &mut slope);
    slope.iter_mut().for_each(|g| *g *= scale);
    let mut values = vec![0.0; jacobian.rows.len()];
    nlp.jacobian(x, &mut values);
    for ((&row, &col), value) in jacobian.rows.iter().zip(&jacobian.cols).zip(&values) {
        slope[col as usize] += value * y[row as usize];
    }
    let mut values = vec![0.0; hessian.rows.len()];
    nlp.hessian(x, scale, y, &mut values);
    let mut curvature = vec![0.0; x.len()];
    for ((&row, &col), value) in hessian.rows.iter().zip(&hessian.cols).zip(&values) {
        if row == col {
            curvature[row as usize] += value;
        }
    }
    (slope, curvature)
}
