//! A closed loop with parts of its disturbance: motions with and without feedback, and the reference, for a slider over the size of the disturbance.

use serde_json::{Value, json};

use crate::report::lines::{LinePlot, Series, over_time};
use crate::report::page::charts::{PLANES, panel};
use crate::report::style::{self, Dash};
use crate::report::tip_path;
use crate::workflow::Tracked;
use crate::workflow::closed_loop::DisturbedLoop;

/// The chart of the parts; none where there are not several.
pub(super) fn chart(parts: &[DisturbedLoop]) -> Option<Value> {
    let [first, _, ..] = parts else { return None };
    let count = first.closed.tracked.len();
    let panels: Vec<Value> = (0..count).flat_map(|place| panels(parts, place)).collect();
    let mut each = parts.iter();
    let whole = each.position(|part| part.size == DisturbedLoop::WHOLE);
    let sizes: Vec<f64> = parts.iter().map(|part| part.size).collect();
    (!panels.is_empty()).then(|| {
        json!({
            "title": "Disturbance",
            "kind": "sizes",
            "sizes": sizes,
            "shown": whole.unwrap_or(parts.len() - 1),
            "panels": panels,
        })
    })
}

/// The panels of a marker or a joint: its path in planes or over time, and its distance from the reference.
fn panels(parts: &[DisturbedLoop], place: usize) -> Vec<Value> {
    let first = &parts[0].closed.tracked[place];
    let name = &first.name;
    let (unit, factor) = match first.unit {
        "m" => ("mm", 1.0),
        _ => ("°", 1_f64.to_degrees()),
    };
    let in_time =
        |times: &[f64], values: &[f64]| over_time(times, values.iter().map(|v| factor * v));
    let coordinate = |one: &Tracked, times: &[f64]| in_time(times, &one.paths[0].value);
    let deviation = |one: &Tracked, times: &[f64]| in_time(times, &one.deviation);
    let plot = |label: &str| LinePlot::over_time(format!("{label} [{unit}]"), Vec::new());
    let in_plane = |plane: [usize; 2]| {
        let points = |one: &Tracked, _: &[f64]| {
            let [a, b] = plane.map(|axis| &one.paths[axis.min(one.paths.len() - 1)].value);
            a.iter().zip(b).map(|(&a, &b)| [a, b]).collect()
        };
        let title = format!("{name}, {}", tip_path::plane_name(plane));
        let plot = tip_path::in_plane(plane, Vec::new());
        panel_of(parts, place, &title, plot, &points, true)
    };
    let mut panels = match first.kind {
        "marker" => PLANES.map(in_plane).to_vec(),
        _ => vec![panel_of(parts, place, name, plot(name), &coordinate, true)],
    };
    let title = format!("{name}, distance from the reference");
    let plot = plot("deviation");
    panels.push(panel_of(parts, place, &title, plot, &deviation, false));
    panels
}

/// Points of a curve of what is tracked at times in ms.
type Points<'a> = &'a dyn Fn(&Tracked, &[f64]) -> Vec<[f64; 2]>;

/// A panel with the curves of all parts, each with the number of its part, and the reference, which is the same for all.
fn panel_of(
    parts: &[DisturbedLoop],
    place: usize,
    title: &str,
    mut plot: LinePlot,
    points: Points<'_>,
    has_reference: bool,
) -> Value {
    let mut sizes = Vec::new();
    for (size, part) in parts.iter().enumerate() {
        let open = part.closed.open_loop.as_ref();
        let open = open.zip(part.closed.tracked_open.get(place));
        let open = open.map(|(open, tracked)| {
            let points = points(tracked, &open.times);
            Series::curve("without feedback", points, style::MUTED)
        });
        let closed = part.closed.tracked.get(place).map(|tracked| Series {
            width: 2.0,
            ..Series::curve("with feedback", points(tracked, &part.times), style::hue(0))
        });
        plot.series.extend(open.into_iter().chain(closed));
        sizes.resize(plot.series.len(), Some(size));
    }
    // A motion that ended early has a part of it.
    let longest = parts.iter().max_by_key(|part| part.times.len());
    if let Some(part) = longest.filter(|_| has_reference) {
        let mut followed = part.closed.tracked[place].clone();
        let paths = followed.paths.iter_mut();
        paths.for_each(|path| path.value.clone_from(&path.reference));
        let points = points(&followed, &part.times);
        let curve = Series::curve("reference", points, style::INK);
        plot.series.push(curve.dashed(Dash::Dashed));
    }
    sizes.resize(plot.series.len(), None);
    let mut value = panel(title, &plot);
    for (k, size) in sizes.into_iter().enumerate() {
        value["series"][k]["size"] = size.into();
    }
    value
}
