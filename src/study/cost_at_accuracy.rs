//! Seconds that each method needs for an accuracy.

use crate::math::significant;
use crate::study::compare::Judged;
use crate::study::measure::Unit;
use crate::study::schedule::{Done, Results};

/// Accuracies that are priced, as parts of the scale of a measure.
pub const ACCURACIES: [f64; 3] = [1e-2, 1e-4, 1e-6];

/// Cost of one accuracy.
#[derive(Debug)]
pub struct CostAtAccuracy {
    /// The accuracy as a part of the scale.
    pub accuracy: f64,
    /// The same as an error, in mm or relative.
    pub error: f64,
    /// Seconds of each method: lower quartile, median and upper quartile; none where it is not reached.
    pub costs: Vec<Option<[f64; 3]>>,
}

impl CostAtAccuracy {
    /// The cheapest method that reaches it.
    pub fn cheapest(&self) -> Option<usize> {
        let reached = (0..self.costs.len()).filter(|&m| self.costs[m].is_some());
        let median = |m: usize| self.costs[m].map_or(f64::INFINITY, |cost| cost[1]);
        reached.min_by(|&a, &b| median(a).total_cmp(&median(b)))
    }
}

/// Returns the costs of the accuracies by each method, those that none reaches included.
pub fn costs_at_accuracy(results: &Results<'_>, judged: &Judged) -> Vec<CostAtAccuracy> {
    let of = |accuracy: f64| {
        let wanted = accuracy * judged.scale;
        let cost = |(m, points): (usize, &Vec<Done<'_>>)| {
            let error = |k: usize| surely(judged, m, k);
            let at = |part: f64| cost(points, part, error, wanted);
            Some([at(0.25)?, at(0.5)?, at(0.75)?])
        };
        CostAtAccuracy {
            accuracy,
            error: wanted,
            costs: results.methods.iter().enumerate().map(cost).collect(),
        }
    };
    ACCURACIES.map(of).into()
}

/// The error that a point does not exceed: its distance from the reference, and the uncertainty of that.
pub fn surely(judged: &Judged, method: usize, point: usize) -> Option<f64> {
    Some(judged.errors[method][point]? + judged.floors[method])
}

/// Seconds, of the given quantile, until errors are `wanted`: between the first point that is so accurate and the one before;
/// those of the first point, where it is.
fn cost(
    points: &[Done<'_>],
    quantile: f64,
    error: impl Fn(usize) -> Option<f64>,
    wanted: f64,
) -> Option<f64> {
    let known = points.iter().enumerate();
    let known: Vec<[f64; 2]> = known
        .filter_map(|(k, done)| Some([done.quantile(quantile)?, error(k)?]))
        .collect();
    let first = known.iter().position(|point| point[1] <= wanted)?;
    let Some(before) = first.checked_sub(1) else {
        return Some(known[0][0]);
    };
    let [[fast, rough], [slow, fine]] = [known[before], known[first]];
    // An error of exactly zero has no place in the diagram.
    if fine <= 0.0 {
        return Some(slow);
    }
    let part = (rough / wanted).ln() / (rough / fine).ln();
    Some(fast * (slow / fast).powf(part))
}

/// An error in the unit that suits it.
pub fn error_text(unit: Unit, error: f64) -> String {
    match unit {
        Unit::Length => length(error),
        Unit::Relative => format!("{error:.1e}").replace(".0e", "e"),
    }
}

/// A length in the unit that suits it.
fn length(millimetres: f64) -> String {
    match millimetres {
        x if x >= 0.1 => format!("{} mm", significant(x, 2)),
        x if x >= 1e-4 => format!("{} µm", significant(1e3 * x, 2)),
        x => format!("{} nm", significant(1e6 * x, 2)),
    }
}
