//! Cost of accuracies by each method: a table with orders and what is not resolved, and the conclusion of a study in a sentence.

use crate::math::significant;
use crate::report::table::aligned;
use crate::study::compare::{Judged, MethodErrors};
use crate::study::limit::How;
use crate::study::measure::{StudyMeasure, Unit};
use crate::study::schedule::{Done, Results};

/// Accuracies that are priced, as parts of the scale of a measure.
const ACCURACIES: [f64; 3] = [1e-2, 1e-4, 1e-6];
/// Times that differ by less than this factor do not differ clearly.
const CLEAR: f64 = 1.2;
/// Errors rise where the next one is larger by this part.
const RISE: f64 = 1e-3;
/// Most informative measures, the first one first.
const FIRST: [StudyMeasure; 4] = [
    StudyMeasure::Path,
    StudyMeasure::End,
    StudyMeasure::Place,
    StudyMeasure::Objective,
];

/// Cost of one accuracy.
struct CostAtAccuracy {
    /// The accuracy as an error, in mm or relative.
    error: f64,
    /// Seconds of each method: lower quartile, median and upper quartile; none where it is not reached.
    costs: Vec<Option<[f64; 3]>>,
    /// Methods that reach it in the least time, the cheapest first: those whose times do not differ clearly from its time.
    cheapest: Vec<usize>,
}

impl CostAtAccuracy {
    fn new(results: &Results<'_>, judged: &Judged, accuracy: f64) -> Self {
        let error = accuracy * judged.scale;
        let methods = results.methods.iter().zip(&judged.methods);
        let costs = methods.map(|(points, errors)| {
            let at = |part: f64| cost(points, part, errors, error);
            Some([at(0.25)?, at(0.5)?, at(0.75)?])
        });
        let costs: Vec<_> = costs.collect();
        let reached = costs.iter().enumerate();
        let mut reached: Vec<_> = reached
            .filter_map(|(m, cost)| Some((m, (*cost)?)))
            .collect();
        reached.sort_by(|a, b| a.1[1].total_cmp(&b.1[1]));
        if let Some(&(_, [_, median, upper])) = reached.first() {
            reached.retain(|(_, cost)| cost[0] <= upper || cost[1] < CLEAR * median);
        }
        Self {
            error,
            costs,
            cheapest: reached.into_iter().map(|(m, _)| m).collect(),
        }
    }
}

/// Rows by measure and method: order, seconds at each accuracy, least error, and status. A star marks the cheapest method and those that do not differ
/// clearly from it.
pub fn cost_table(results: &Results<'_>, judged: &[Judged]) -> String {
    let mut head = ["error", "method", "order"].map(str::to_owned).to_vec();
    head.extend(ACCURACIES.map(|accuracy| format!("cost at {accuracy:e} [s]")));
    head.extend(["least error", "status"].map(str::to_owned));
    let mut rows = vec![head];
    for judged in judged.iter().filter(|judged| judged.measure.has_order()) {
        let costs = ACCURACIES.map(|accuracy| CostAtAccuracy::new(results, judged, accuracy));
        for (m, method) in results.study.methods.iter().enumerate() {
            let own = &judged.methods[m];
            let order = own.order.map(|order| format!("{order:.2}"));
            let cost = |at: &CostAtAccuracy| {
                let star = match at.cheapest.contains(&m) && results.study.methods.len() > 1 {
                    true => "*",
                    false => "",
                };
                at.costs[m].map(|[_, median, _]| format!("{}{star}", significant(median, 3)))
            };
            let errors = (0..own.errors.len()).filter_map(|k| own.surely(k));
            let least = errors.reduce(f64::min);
            let least = least.map(|error| error_text(judged.measure.unit(), error));
            let mut row = vec![judged.measure.name(), method.name.clone()];
            let cells = [order]
                .into_iter()
                .chain(costs.iter().map(cost))
                .chain([least]);
            row.extend(cells.map(|cell| cell.unwrap_or_else(|| "–".to_owned())));
            row.push(status(&results.methods[m], own));
            rows.push(row);
        }
    }
    aligned(&rows)
}

/// The parts of a measure of a method that are not resolved.
fn status(points: &[Done<'_>], judged: &MethodErrors) -> String {
    let count = |is: fn(&Done<'_>) -> bool| points.iter().filter(|done| is(done)).count();
    let unanswered = count(|done| !done.first.is_solved);
    let halved = count(|done| done.halved() > 0);
    let whole = (0..points.len()).filter(|&k| points[k].halved() == 0);
    let known: Vec<f64> = whole.filter_map(|k| judged.known(k)).collect();
    let rises = known
        .windows(2)
        .any(|pair| pair[1] > (1.0 + RISE) * pair[0]);
    let how = judged.limit.as_ref().map(|limit| limit.how);
    let open = [
        (unanswered > 0).then(|| format!("{unanswered} of {} without an answer", points.len())),
        (halved > 0).then(|| format!("{halved} of {} with halved steps", points.len())),
        rises.then(|| "errors rise".to_owned()),
        judged.order.is_none().then(|| "no order".to_owned()),
        matches!(how, Some(How::NoOrder | How::TooFew))
            .then(|| "limit not extrapolated".to_owned()),
    ];
    let open: Vec<String> = open.into_iter().flatten().collect();
    match open.is_empty() {
        true => "resolved".to_owned(),
        false => open.join(", "),
    }
}

/// The conclusion of a study in a sentence: how many points have an answer, and the cheapest methods at the finest accuracy that is reached.
pub fn conclusion(results: &Results<'_>, judged: &[Judged]) -> String {
    let [solved, all] = results.solved();
    let of = |measure: StudyMeasure| judged.iter().find(|judged| judged.measure == measure);
    let with_order = || judged.iter().find(|judged| judged.measure.has_order());
    let reported = FIRST.into_iter().find_map(of).or_else(with_order);
    let reached = reported.map(|judged| {
        let (label, reached) = (judged.measure.label(), reached(results, judged));
        format!("; {label}: {reached}")
    });
    let early = if results.is_interrupted {
        " (interrupted)"
    } else {
        ""
    };
    format!(
        "{solved} of {all} points have an answer{early}{}.",
        reached.unwrap_or_default()
    )
}

/// The finest accuracy that is reached and its cheapest methods, or the least error.
fn reached(results: &Results<'_>, judged: &Judged) -> String {
    let unit = judged.measure.unit();
    let name = |m: usize| format!("`{}`", results.study.methods[m].name);
    let costs = ACCURACIES.map(|accuracy| CostAtAccuracy::new(results, judged, accuracy));
    for at in costs.iter().rev() {
        let first = at.cheapest.first();
        if let Some([_, median, _]) = first.and_then(|&m| at.costs[m]) {
            let names: Vec<String> = at.cheapest.iter().map(|&m| name(m)).collect();
            let (error, names) = (error_text(unit, at.error), names.join(" and "));
            return format!(
                "{error} costs least by {names}, {} s",
                significant(median, 2)
            );
        }
    }
    let all = judged.methods.iter().enumerate();
    let all = all.flat_map(|(m, own)| (0..own.errors.len()).map(move |k| (m, own.surely(k))));
    let known = all.filter_map(|(m, error)| Some((m, error?)));
    match known.min_by(|a, b| a.1.total_cmp(&b.1)) {
        Some((m, error)) => {
            let (coarsest, error) = (error_text(unit, costs[0].error), error_text(unit, error));
            format!(
                "{coarsest} is not reached, the least error is {error} by {}",
                name(m)
            )
        }
        None => "no error is known".to_owned(),
    }
}

/// Seconds, of the given quantile, until errors are `wanted`: between the first point that is so accurate and the one before;
/// those of the first point, where it is.
fn cost(points: &[Done<'_>], quantile: f64, errors: &MethodErrors, wanted: f64) -> Option<f64> {
    let known = points.iter().enumerate();
    let known: Vec<[f64; 2]> = known
        .filter_map(|(k, done)| Some([done.quantile(quantile)?, errors.surely(k)?]))
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
fn error_text(unit: Unit, error: f64) -> String {
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
