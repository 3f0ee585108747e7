//! References of markers and joints next to their motion: table and figure.

use crate::report::axes::{Axis, Extent};
use crate::report::lines::{LinePlot, Series};
use crate::report::origin::Origin;
use crate::report::style;
use crate::report::table::csv;
use crate::workflow::Tracked;

/// `tracking.csv`: one row per instant with each coordinate, its reference, and the deviation.
pub fn table(times: &[f64], tracked: &[Tracked], origin: &Origin) -> String {
    let mut header = vec!["time [ms]".to_owned()];
    let mut columns: Vec<&[f64]> = vec![times];
    for one in tracked {
        let unit = unit(one);
        for path in &one.paths {
            header.push(format!("{} [{unit}]", path.name));
            header.push(format!("{}_reference [{unit}]", path.name));
            columns.extend([&path.value[..], &path.reference[..]]);
        }
        header.push(format!("{}_deviation [{unit}]", one.name));
        columns.push(&one.deviation);
    }
    let rows = (0..times.len()).map(|k| columns.iter().map(move |column| column[k]));
    csv(&origin.line(), header.into_iter(), rows)
}

fn unit(one: &Tracked) -> &'static str {
    match one.unit {
        "m" => "mm",
        unit => unit,
    }
}

/// Deviations over time in s: lengths in mm, angles in degrees.
pub fn curves(times: &[f64], tracked: &[Tracked]) -> Vec<Series> {
    let curve = |(i, one): (usize, &Tracked)| {
        let factor = match one.unit {
            "rad" => 1_f64.to_degrees(),
            _ => 1.0,
        };
        let instants = times.iter().zip(&one.deviation);
        let points = instants.map(|(t, e)| [t / 1e3, factor * e]).collect();
        Series::curve(one.name.clone(), points, style::hue(i))
    };
    tracked.iter().enumerate().map(curve).collect()
}

/// The same by their units, each with the label of its axis.
pub(super) fn by_unit(times: &[f64], tracked: &[Tracked]) -> Vec<(&'static str, Vec<Series>)> {
    let curves = curves(times, tracked);
    let labels = [("m", "deviation [mm]"), ("rad", "deviation [°]")];
    let each = labels.map(|(unit, label)| {
        let of = tracked.iter().zip(&curves);
        let of = of.filter(|(one, _)| one.unit == unit);
        (label, of.map(|(_, curve)| curve.clone()).collect())
    });
    each.to_vec()
}

/// Label of the vertical axis of [`curves`].
pub fn label(tracked: &[Tracked]) -> &'static str {
    let has = |unit| tracked.iter().any(|one| one.unit == unit);
    match (has("rad"), has("m")) {
        (false, _) => "deviation [mm]",
        (true, false) => "deviation [°]",
        (true, true) => "deviation [°, mm]",
    }
}

/// `tracking.svg`: deviations over time in s.
pub fn svg(times: &[f64], tracked: &[Tracked], origin: &Origin) -> String {
    LinePlot::new(
        Axis::linear("time [s]", Extent::Tight),
        Axis::linear(label(tracked), Extent::Padded),
        curves(times, tracked),
    )
    .svg(origin)
}

/// The path that a marker follows in a plane, where it follows one in both directions.
pub fn reference(tracked: &[Tracked], marker: &str, plane: [usize; 2]) -> Option<Vec<[f64; 2]>> {
    let of = |one: &&Tracked| one.kind == "marker" && one.name == marker;
    let one = tracked.iter().find(of)?;
    let along = |axis: usize| {
        let mut paths = one.paths.iter();
        paths.find(|path| path.axis == Some(axis))
    };
    let [a, b] = plane.map(along);
    let (a, b) = (a?, b?);
    let points = a.reference.iter().zip(&b.reference);
    Some(points.map(|(&a, &b)| [a, b]).collect())
}
