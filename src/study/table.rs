//! `table.csv` with every number in full, and `table.txt` to read.

use crate::math::significant;
use crate::report::origin::Origin;
use crate::report::table::{aligned, cells_csv};
use crate::study::compare::Judged;
use crate::study::measure::Unit;
use crate::study::read::Study;
use crate::study::schedule::{Done, Results};

/// One row per point: its method, its input, how it ended, seconds and errors; each number reads back identical.
pub(super) fn csv(
    study: &Study,
    results: &Results<'_>,
    judged: &[Judged],
    origin: &Origin,
) -> String {
    let mut header: Vec<String> = [
        "method",
        "refined",
        "value",
        "problem",
        "overrides",
        "status",
        "runs",
        "median [s]",
        "lower quartile [s]",
        "upper quartile [s]",
        "least [s]",
        "iterations",
        "halved steps",
    ]
    .map(str::to_owned)
    .into();
    header.extend(judged.iter().map(|judged| judged.measure.head()));
    let mut rows = vec![header];
    for (m, (method, points)) in study.methods.iter().zip(&results.methods).enumerate() {
        for (k, done) in points.iter().enumerate() {
            let seconds = [0.5, 0.25, 0.75, 0.0].map(|part| full(done.quantile(part)));
            let iterations = done.seen.as_ref().map(|seen| seen.iterations.to_string());
            let mut row = vec![
                method.name.clone(),
                method.refined.clone(),
                done.point.label.clone(),
                done.point.problem.display().to_string(),
                done.point.set.join("; "),
                done.first.status.to_owned(),
                done.seconds.len().to_string(),
            ];
            row.extend(seconds);
            row.push(iterations.unwrap_or_default());
            row.push(done.halved().to_string());
            row.extend(judged.iter().map(|judged| full(judged.errors[m][k])));
            rows.push(row);
        }
    }
    cells_csv(&rows, origin)
}

/// The shortest decimal that reads back as the same number.
fn full(value: Option<f64>) -> String {
    value.map_or_else(String::new, |value| format!("{value:?}"))
}

/// The same in columns, rounded, with the orders below.
///
/// An error that is no larger than the uncertainty of the reference is reported as less than both together.
pub(super) fn text(study: &Study, results: &Results<'_>, judged: &[Judged]) -> String {
    let same = |method: &crate::study::read::Method| method.refined == study.methods[0].refined;
    let refined = match study.methods.iter().all(same) {
        true => study.methods[0].refined.clone(),
        false => "refined".to_owned(),
    };
    let mut header: Vec<String> = vec!["method".to_owned(), refined];
    header.extend(["status", "seconds", "iterations"].map(str::to_owned));
    header.extend(judged.iter().map(|judged| judged.measure.head()));
    let mut rows = vec![header];
    for (m, (method, points)) in study.methods.iter().zip(&results.methods).enumerate() {
        for (k, done) in points.iter().enumerate() {
            let iterations = done.seen.as_ref().map(|seen| seen.iterations.to_string());
            let mut row = vec![
                method.name.clone(),
                done.point.label.clone(),
                match done.halved() {
                    0 => done.first.status.replace('_', " "),
                    halved => format!("{}, {halved} halved", done.first.status.replace('_', " ")),
                },
                done.median().map_or_else(dash, |s| significant(s, 3)),
                iterations.unwrap_or_else(dash),
            ];
            row.extend(judged.iter().map(|judged| match judged.errors[m][k] {
                None => dash(),
                Some(error) if judged.known(m, k).is_none() && judged.floors[m] > 0.0 => {
                    format!("<{:.1e}", judged.floors[m] + error)
                }
                Some(0.0) => "0".to_owned(),
                Some(error) => format!("{error:.2e}"),
            }));
            rows.push(row);
        }
    }
    let shows_order = |m: usize| judged.iter().any(|judged| judged.orders[m].is_some());
    for (m, method) in study
        .methods
        .iter()
        .enumerate()
        .filter(|(m, _)| shows_order(*m))
    {
        let mut row = vec![method.name.clone(), "order".to_owned()];
        row.extend([String::new(), String::new(), String::new()]);
        row.extend(judged.iter().map(|judged| match judged.orders[m] {
            Some(order) => format!("{order:.2}"),
            None => dash(),
        }));
        rows.push(row);
    }
    aligned(&rows)
}

fn dash() -> String {
    "–".to_owned()
}

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
