//! The table of all points: `table.csv` with every number in full, and `table.txt` to read.

use crate::math::significant;
use crate::report::table::Cell;
use crate::study::compare::Judged;
use crate::study::schedule::Results;

/// One row per point: its method, its input, how it ended, seconds and errors. In full each number reads back identical.
///
/// An error that is no larger than the uncertainty of the reference is shown as less than both together.
pub(super) fn table(results: &Results<'_>, judged: &[Judged]) -> Vec<Vec<Cell>> {
    let methods = &results.study.methods;
    let refined = &methods[0].refined;
    let is_same = methods.iter().all(|method| method.refined == *refined);
    let mut header = vec![
        Cell::same("method"),
        Cell::unshown("refined"),
        Cell::new("value", if is_same { refined } else { "refined" }),
        Cell::unshown("problem"),
        Cell::unshown("overrides"),
        Cell::same("status"),
        Cell::unshown("runs"),
        Cell::new("median [s]", "seconds"),
        Cell::unshown("lower quartile [s]"),
        Cell::unshown("upper quartile [s]"),
        Cell::unshown("least [s]"),
        Cell::same("iterations"),
        Cell::unshown("halved steps"),
    ];
    let measures = judged.iter().map(|judged| judged.measure);
    header.extend(measures.map(|measure| Cell::same(measure.head())));
    let none = || Cell::new("", "–");
    let mut rows = vec![header];
    for (m, (method, points)) in results.each().enumerate() {
        for (k, done) in points.iter().enumerate() {
            // The shortest decimal that reads back as the same number.
            let full = |value: f64| format!("{value:?}");
            let part = |part| Cell::unshown(done.quantile(part).map_or_else(String::new, full));
            let median = |seconds| Cell::new(full(seconds), significant(seconds, 3));
            let iterations = done.seen.as_ref().map(|seen| seen.iterations);
            let status = done.first.status.replace('_', " ");
            let mut row = vec![
                Cell::same(&method.name),
                Cell::unshown(&method.refined),
                Cell::same(&done.point.label),
                Cell::unshown(done.point.problem.display()),
                Cell::unshown(done.point.set.join("; ")),
                match done.halved() {
                    0 => Cell::new(done.first.status, status),
                    halved => Cell::new(done.first.status, format!("{status}, {halved} halved")),
                },
                Cell::unshown(done.seconds.len()),
                done.median().map_or_else(none, median),
                part(0.25),
                part(0.75),
                part(0.0),
                iterations.map_or_else(none, Cell::same),
                Cell::unshown(done.halved()),
            ];
            row.extend(judged.iter().map(|judged| {
                let own = &judged.methods[m];
                let Some(error) = own.errors[k] else {
                    return none();
                };
                let shown = match error {
                    _ if own.known(k).is_none() && own.floor > 0.0 => {
                        format!("<{:.1e}", own.floor + error)
                    }
                    0.0 => "0".to_owned(),
                    _ => format!("{error:.2e}"),
                };
                Cell::new(full(error), shown)
            }));
            rows.push(row);
        }
    }
    rows
}
