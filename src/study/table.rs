//! `table.csv` with every number in full, and `table.txt` to read.

use crate::math::significant;
use crate::report::origin::Origin;
use crate::report::table::{aligned, cells_csv};
use crate::study::compare::Judged;
use crate::study::read::Method;
use crate::study::schedule::Results;

/// One row per point: its method, its input, how it ended, seconds and errors; each number reads back identical.
pub(super) fn csv(results: &Results<'_>, judged: &[Judged], origin: &Origin) -> String {
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
    for (m, (method, points)) in results.each().enumerate() {
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
            row.extend(
                judged
                    .iter()
                    .map(|judged| full(judged.methods[m].errors[k])),
            );
            rows.push(row);
        }
    }
    cells_csv(&rows, origin)
}

/// The shortest decimal that reads back as the same number.
fn full(value: Option<f64>) -> String {
    value.map_or_else(String::new, |value| format!("{value:?}"))
}

/// The same in columns, rounded.
///
/// An error that is no larger than the uncertainty of the reference is reported as less than both together.
pub(super) fn text(results: &Results<'_>, judged: &[Judged]) -> String {
    let same = |method: &Method| method.refined == results.study.methods[0].refined;
    let refined = match results.study.methods.iter().all(same) {
        true => results.study.methods[0].refined.clone(),
        false => "refined".to_owned(),
    };
    let mut header: Vec<String> = vec!["method".to_owned(), refined];
    header.extend(["status", "seconds", "iterations"].map(str::to_owned));
    header.extend(judged.iter().map(|judged| judged.measure.head()));
    let mut rows = vec![header];
    for (m, (method, points)) in results.each().enumerate() {
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
            let own = judged.iter().map(|judged| &judged.methods[m]);
            row.extend(own.map(|own| match own.errors[k] {
                None => dash(),
                Some(error) if own.known(k).is_none() && own.floor > 0.0 => {
                    format!("<{:.1e}", own.floor + error)
                }
                Some(0.0) => "0".to_owned(),
                Some(error) => format!("{error:.2e}"),
            }));
            rows.push(row);
        }
    }
    aligned(&rows)
}

fn dash() -> String {
    "–".to_owned()
}
