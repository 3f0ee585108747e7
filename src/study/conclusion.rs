//! Conclusion of a study in a few sentences made of its own results: costs, observed orders, points without an answer.

use crate::control::problem::{Task, Voltages};
use crate::math::significant;
use crate::study::compare::Judged;
use crate::study::limit::How;
use crate::study::measure::{StudyMeasure, Unit};
use crate::study::read::{Study, StudyPoint};
use crate::study::record::of_reference;
use crate::study::schedule::{Done, Results};
use crate::study::table::{CostAtAccuracy, costs_at_accuracy, error_text, surely};

/// Times that differ by less than this factor do not differ clearly.
const CLEAR: f64 = 1.2;
/// Most informative measures, the first one first; where a study has none of them, the costs of all that fall with refinement
/// are reported, and the orders of the first of these.
const FIRST: [StudyMeasure; 4] = [
    StudyMeasure::Path,
    StudyMeasure::End,
    StudyMeasure::Place,
    StudyMeasure::Objective,
];
/// An order that is further from the one of the method is reported as such.
const FAR: f64 = 0.4;
/// Errors rise where the next one is larger by this part.
const RISE: f64 = 1e-3;
/// Points that are listed by name.
const LISTED: usize = 3;

/// The conclusion of a study: plain sentences, names of methods in backticks.
pub fn conclusion(study: &Study, results: &Results<'_>, judged: &[Judged]) -> String {
    let mut sentences = Vec::new();
    for (index, judged) in chosen(judged).into_iter().enumerate() {
        sentences.extend(cost(study, results, judged));
        if index == 0 {
            sentences.extend(orders(study, results, judged));
            sentences.extend(references(study, judged));
        }
    }
    sentences.extend(unanswered(study, results));
    sentences.extend(halved(study, results));
    if results.is_interrupted {
        sentences.push("It was interrupted: these are the results up to then".to_owned());
    }
    sentences
        .iter()
        .map(|s| format!("{s}. "))
        .collect::<String>()
        .trim_end()
        .to_owned()
}

/// Returns the measures that are reported.
fn chosen(judged: &[Judged]) -> Vec<&Judged> {
    let of = |measure: StudyMeasure| judged.iter().find(|judged| judged.measure == measure);
    match FIRST.into_iter().find_map(of) {
        Some(one) => vec![one],
        None => judged
            .iter()
            .filter(|judged| judged.measure.has_order())
            .collect(),
    }
}

/// Names the method that reaches each accuracy in the least time.
fn cost(study: &Study, results: &Results<'_>, judged: &Judged) -> Option<String> {
    let unit = judged.measure.unit();
    let mut parts = Vec::new();
    for at_accuracy in costs_at_accuracy(results, judged) {
        let Some(cheapest) = at_accuracy.cheapest() else {
            let (m, error) = least(judged)?;
            let found = format!(
                "{} is not reached{}: the least error is {}",
                error_text(unit, at_accuracy.error),
                if several(study) { " by any method" } else { "" },
                error_text(unit, error)
            );
            let by = format!(" by {}", name(study, m));
            parts.push(found + if several(study) { &by } else { "" });
            break;
        };
        parts.push(paid(study, &at_accuracy, cheapest, unit));
    }
    let label = judged.measure.label();
    Some(format!(
        "{}{}: {}",
        label[..1].to_uppercase(),
        &label[1..],
        parts.join("; ")
    ))
}

/// Describes the cost of one accuracy by the cheapest method, and by the next.
fn paid(study: &Study, at_accuracy: &CostAtAccuracy, cheapest: usize, unit: Unit) -> String {
    let error = error_text(unit, at_accuracy.error);
    let [_, median, upper] = at_accuracy.costs[cheapest].unwrap_or([f64::NAN; 3]);
    let mut others: Vec<(usize, [f64; 3])> = (at_accuracy.costs.iter().enumerate())
        .filter(|(m, _)| *m != cheapest)
        .filter_map(|(m, cost)| Some((m, (*cost)?)))
        .collect();
    others.sort_by(|a, b| a.1[1].total_cmp(&b.1[1]));
    let is_clear = |cost: &[f64; 3]| cost[0] > upper && cost[1] >= CLEAR * median;
    let alike = others
        .iter()
        .filter(|(_, cost)| !is_clear(cost))
        .map(|(m, _)| *m);
    let alike: Vec<usize> = std::iter::once(cheapest).chain(alike).collect();
    let next = others.iter().find(|(_, cost)| is_clear(cost));
    let time = seconds(median);
    if !several(study) {
        return format!("{error} costs {time}");
    }
    let reached = names(study, &alike);
    match (next, alike.as_slice()) {
        (None, [_]) => format!("only {reached} reaches {error}, in {time}"),
        (Some((m, cost)), [_]) => format!(
            "{error} costs least by {reached} ({time}; {} takes {} times as long)",
            name(study, *m),
            significant(cost[1] / median, 2)
        ),
        (_, [.., last]) => {
            let most = at_accuracy.costs[*last].map_or(f64::NAN, |cost| cost[1]);
            let range = match seconds(most) {
                same if same == time => time,
                most => format!("{time} to {most}"),
            };
            let beyond = next.map_or(String::new(), |(m, cost)| {
                let times = significant(cost[1] / median, 2);
                format!(" ({} takes {times} times as long)", name(study, *m))
            });
            format!("{error} costs least by {reached}, {range} without a clear difference{beyond}")
        }
        (_, []) => String::new(),
    }
}

/// The least error that is sure, and the method that has it.
fn least(judged: &Judged) -> Option<(usize, f64)> {
    let all = judged.errors.iter().enumerate();
    let all = all.flat_map(|(m, errors)| {
        (0..errors.len()).filter_map(move |k| Some((m, surely(judged, m, k)?)))
    });
    all.min_by(|a, b| a.1.total_cmp(&b.1))
}

/// Orders that are observed, and errors that show none.
fn orders(study: &Study, results: &Results<'_>, judged: &Judged) -> Option<String> {
    let mut shown = Grouped::default();
    let mut odd = Vec::new();
    let mut rising = Grouped::default();
    for (m, points) in results.methods.iter().enumerate() {
        let known = known(judged, points, m);
        let expected = expected(points, judged.measure);
        if let Some(order) = judged.orders[m] {
            let far = expected.filter(|expected| (order - expected).abs() > FAR);
            let beside = far.map_or(String::new(), |p| format!(" (where {p} is expected)"));
            shown.add(format!("{order:.2}{beside}"), m);
        }
        match risen(judged, &known) {
            Some(risen) => rising.add(risen, m),
            None if judged.orders[m].is_none() && known.len() > 1 => {
                let slopes = known.windows(2).map(|pair| format!("{:.1}", slope(pair)));
                let slopes = slopes.collect::<Vec<_>>().join(", ");
                odd.push(match several(study) {
                    true => format!("{} ({slopes})", name(study, m)),
                    false => slopes,
                });
            }
            None => {}
        }
    }
    let mut parts = Vec::new();
    if !shown.0.is_empty() {
        let each = shown.0.iter().map(|(order, methods)| match several(study) {
            true => format!("{} {order}", names(study, methods)),
            false => order.clone(),
        });
        let each: Vec<_> = each.collect();
        parts.push(format!("Observed order: {}", each.join(", ")));
    }
    if !odd.is_empty() {
        let of = match several(study) {
            true => format!(" of {}", list(odd)),
            false => format!(" ({})", odd.concat()),
        };
        parts.push(format!(
            "errors{of} show no single order from point to point"
        ));
    }
    parts.extend(
        rising
            .0
            .iter()
            .map(|(words, methods)| match several(study) {
                true => format!("errors of {} {words}", names(study, methods)),
                false => format!("errors {words}"),
            }),
    );
    let text = parts.join("; ");
    let first = text.chars().next()?;
    Some(format!(
        "{}{}",
        first.to_uppercase(),
        &text[first.len_utf8()..]
    ))
}

/// Points of a method that are of their size, with errors that are known: label, size and error.
fn known<'a>(judged: &Judged, points: &'a [Done<'_>], m: usize) -> Vec<(&'a str, [f64; 2])> {
    let each = points
        .iter()
        .enumerate()
        .filter(|(_, done)| done.halved() == 0);
    let known = each.filter_map(|(k, done)| {
        let error = judged.known(m, k)?;
        Some((done.point.label.as_str(), [done.point.size, error]))
    });
    known.collect()
}

/// Describes errors that rise under refinement.
fn risen(judged: &Judged, known: &[(&str, [f64; 2])]) -> Option<String> {
    let rises = |pair: &&[(&str, [f64; 2])]| pair[1].1[1] > (1.0 + RISE) * pair[0].1[1];
    let risen: Vec<_> = known.windows(2).filter(rises).collect();
    let [(before, [_, less]), (after, [_, more])] = risen.first()? else {
        return None;
    };
    let unit = judged.measure.unit();
    let (less, more) = (error_text(unit, *less), error_text(unit, *more));
    let again = match risen.len() {
        1 => String::new(),
        count => format!(", and so {count} times"),
    };
    let by = match less == more {
        true => format!("beyond {more}"),
        false => format!("from {less} to {more}"),
    };
    Some(format!(
        "do not fall throughout: from {before} to {after} they rise {by}{again}"
    ))
}

fn slope(pair: &[(&str, [f64; 2])]) -> f64 {
    let [[h, error], [finer, left]] = [pair[0].1, pair[1].1];
    (error / left).ln() / (h / finer).ln()
}

/// The order of the method, where it is the step of a motion under constant voltages that is refined.
fn expected(points: &[Done<'_>], measure: StudyMeasure) -> Option<f64> {
    let has = matches!(
        measure,
        StudyMeasure::End | StudyMeasure::Path | StudyMeasure::EnergyBalance
    );
    let of = |point: &StudyPoint| match &point.loaded.task {
        Task::Simulate(task) if task.tolerance.is_none() => match task.voltages {
            Voltages::Constant(_) => {
                Some((task.step / point.size, task.solving.integrator.order()))
            }
            Voltages::Sampled { .. } | Voltages::Signals(_) => None,
        },
        _ => None,
    };
    let (ratio, order) = of(points.first()?.point)?;
    let is_same = |done: &Done<'_>| {
        of(done.point).is_some_and(|(r, p)| (r / ratio - 1.0).abs() < 1e-9 && p == order)
    };
    (has && points.iter().all(is_same)).then_some(order as f64)
}

/// References that are no limit but a finest value.
fn references(study: &Study, judged: &Judged) -> Option<String> {
    let mut kinds = Grouped::default();
    let mut single = Vec::new();
    for (index, limit) in judged.limits.iter().enumerate() {
        let Some(limit) = limit else { continue };
        match limit.how {
            How::NoOrder => kinds.add("no order is observed".to_owned(), index),
            How::TooFew if limit.uncertainty.is_none() => single.push(index),
            How::TooFew => kinds.add("there are fewer than three".to_owned(), index),
            How::Extrapolated | How::Rounding => {}
        }
    }
    let names = |indices: &[usize]| {
        let each = indices.iter();
        list(
            each.map(|&i| format!("`{}`", of_reference(study, judged, i)))
                .collect(),
        )
    };
    let each = kinds.0.iter().map(|(why, indices)| {
        format!(
            "Errors are distances from the finest value of {}, as {why}, and its own error is estimated from the last differences by the order 0.5",
            names(indices)
        )
    });
    let single = (!single.is_empty()).then(|| {
        let names = names(&single);
        format!("Errors are not known, as a single point of {names} has an answer")
    });
    let text = each.chain(single).collect::<Vec<_>>().join(". ");
    (!text.is_empty()).then_some(text)
}

/// Points that have no answer.
fn unanswered(study: &Study, results: &Results<'_>) -> Option<String> {
    let all = results.methods.iter().map(Vec::len).sum::<usize>();
    let why =
        |done: &Done<'_>| (!done.first.is_solved).then(|| done.first.status.replace('_', " "));
    let (count, points) = listed(study, results, why)?;
    Some(match count == all {
        true => format!("No point has an answer: {points}"),
        false => format!("{count} of {all} points have no answer: {points}"),
    })
}

/// Points of which steps were halved.
fn halved(study: &Study, results: &Results<'_>) -> Option<String> {
    let why = |done: &Done<'_>| match done.halved() {
        0 => None,
        1 => Some("1 step".to_owned()),
        count => Some(format!("{count} steps")),
    };
    let (_, points) = listed(study, results, why)?;
    Some(format!(
        "Steps were halved, so that neither limits nor orders count the point: {points}"
    ))
}

/// Returns the number of points with something to report, and the first of them with it.
fn listed(
    study: &Study,
    results: &Results<'_>,
    why: impl Fn(&Done<'_>) -> Option<String>,
) -> Option<(usize, String)> {
    let mut all = Vec::new();
    for (m, points) in results.methods.iter().enumerate() {
        let refined = &study.methods[m].refined;
        let told = points.iter().filter_map(|done| {
            let why = why(done)?;
            Some(format!(
                "{}, {refined} {} ({why})",
                name(study, m),
                done.point.label
            ))
        });
        all.extend(told);
    }
    let count = all.len();
    if count > LISTED {
        all.truncate(LISTED);
        all.push(format!("{} more", count - LISTED));
    }
    (count > 0).then(|| (count, all.join("; ")))
}

/// Methods of which the same is said.
#[derive(Debug, Default)]
pub(super) struct Grouped(pub(super) Vec<(String, Vec<usize>)>);

impl Grouped {
    /// Says something of a method.
    pub(super) fn add(&mut self, words: String, method: usize) {
        match self.0.iter_mut().find(|(other, _)| *other == words) {
            Some((_, methods)) => methods.push(method),
            None => self.0.push((words, vec![method])),
        }
    }
}

/// Returns true if methods need names.
pub(super) fn several(study: &Study) -> bool {
    study.methods.len() > 1
}

/// The name of a method in backticks.
pub(super) fn name(study: &Study, method: usize) -> String {
    format!("`{}`", study.methods[method].name)
}

/// The names of methods.
pub(super) fn names(study: &Study, methods: &[usize]) -> String {
    list(methods.iter().map(|&m| name(study, m)).collect())
}

/// Names one after the other, with an "and" before the last.
pub(super) fn list(mut names: Vec<String>) -> String {
    match (names.pop(), names.is_empty()) {
        (Some(last), false) => format!("{} and {last}", names.join(", ")),
        (last, _) => last.unwrap_or_default(),
    }
}

/// A time in the unit that suits it.
pub(super) fn seconds(seconds: f64) -> String {
    match seconds {
        x if x >= 1.0 => format!("{} s", significant(x, 2)),
        x if x >= 1e-3 => format!("{} ms", significant(1e3 * x, 2)),
        x => format!("{} µs", significant(1e6 * x, 2)),
    }
}
