//! Work-precision diagrams: error against seconds, a curve per method, both axes logarithmic.

use crate::report::axes::Axis;
use crate::report::lines::{LinePlot, Mark, Series};
use crate::report::style;
use crate::study::compare::Judged;
use crate::study::read::Study;
use crate::study::schedule::Results;

/// The diagram of one measure; none where no error is above zero.
///
/// The legend names the observed order; the first and the last point of a curve are labelled with the refined value.
pub(super) fn plot(study: &Study, results: &Results<'_>, judged: &Judged) -> Option<LinePlot> {
    let mut series = Vec::new();
    for (m, (method, points)) in study.methods.iter().zip(&results.methods).enumerate() {
        let drawn = points.iter().enumerate().filter_map(|(k, done)| {
            let place = [done.median()?, judged.known(m, k)?];
            Some((place, done.point.label.clone()))
        });
        let (places, mut labels): (Vec<_>, Vec<_>) = drawn.unzip();
        if places.is_empty() {
            continue;
        }
        let last = labels.len() - 1;
        for (k, label) in labels.iter_mut().enumerate() {
            if k != 0 && k != last {
                label.clear();
            }
        }
        let name = match judged.orders[m] {
            Some(order) => format!("{}, order {order:.1}", method.name),
            None => method.name.clone(),
        };
        let curve = Series::curve(name, places, style::hue(m));
        series.push(curve.marked(Mark::Disc).labelled(labels));
    }
    if series.is_empty() {
        return None;
    }
    let unit = judged.measure.unit().suffix();
    Some(LinePlot {
        frame: [400.0, 290.0],
        ..LinePlot::new(
            Axis::log("median time of a solution [s]"),
            Axis::log(format!("{}{unit}", judged.measure.label())),
            series,
        )
    })
}
