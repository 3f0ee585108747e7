//! A closed loop with parts of its disturbance: motions with and without feedback, and the reference, for a slider over the size of the disturbance.

use serde_json::{Value, json};

use crate::report::axes::Scale;
use crate::report::lines::{Series, over_time};
use crate::report::page::charts::{axis, series};
use crate::report::style::{self, Dash};
use crate::workflow::Tracked;
use crate::workflow::closed_loop::DisturbedLoop;

/// The part that is the problem itself.
const WHOLE: f64 = 1.0;
/// Planes in which paths are drawn, horizontal axis first.
const PLANES: [[usize; 2]; 3] = [[0, 1], [2, 1], [0, 2]];
const AXES: [&str; 3] = ["x", "y", "z"];

/// The chart of the parts; none where there are not several.
pub(super) fn chart(parts: &[DisturbedLoop]) -> Option<Value> {
    let [first, _, ..] = parts else { return None };
    let count = first.closed.tracked.len();
    let panels: Vec<Value> = (0..count).flat_map(|place| panels(parts, place)).collect();
    let whole = parts.iter().position(|part| part.size == WHOLE);
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

/// The panels of a marker or a joint.
fn panels(parts: &[DisturbedLoop], place: usize) -> Vec<Value> {
    let first = &parts[0].closed.tracked[place];
    let name = &first.name;
    let mut out = Vec::new();
    if first.kind == "marker" {
        for plane in PLANES {
            let [a, b] = plane.map(|axis| AXES[axis]);
            let label = |axis: &str| format!("{axis} [mm]");
            let of = |one: &Tracked, _: &[f64], is_reference: bool| {
                let along = plane.map(|axis| path(one, axis, is_reference, 1.0));
                let [a, b] = along;
                a.into_iter().zip(b).map(|(a, b)| [a, b]).collect()
            };
            let title = format!("{name}, {a}–{b}");
            let curves = curves(parts, place, (&of, true));
            out.push(panel(&title, [&label(a), &label(b)], true, curves));
        }
    } else {
        let (unit, factor) = unit(first);
        let of = |one: &Tracked, times: &[f64], is_reference: bool| {
            over_time(times, path(one, 0, is_reference, factor))
        };
        let label = format!("{name} [{unit}]");
        let curves = curves(parts, place, (&of, true));
        out.push(panel(name, ["time [s]", &label], false, curves));
    }
    let (unit, factor) = unit(first);
    let of = |one: &Tracked, times: &[f64], _: bool| {
        over_time(times, one.deviation.iter().map(|v| factor * v))
    };
    let label = format!("deviation [{unit}]");
    let title = format!("{name}, distance from the reference");
    let curves = curves(parts, place, (&of, false));
    out.push(panel(&title, ["time [s]", &label], false, curves));
    out
}

/// Unit of what is tracked, and its factor from mm or rad.
fn unit(of: &Tracked) -> (&'static str, f64) {
    match of.unit {
        "m" => ("mm", 1.0),
        _ => ("°", 1_f64.to_degrees()),
    }
}

/// Values or references along a direction.
fn path(of: &Tracked, axis: usize, is_reference: bool, factor: f64) -> Vec<f64> {
    let path = &of.paths[axis.min(of.paths.len() - 1)];
    let values = if is_reference {
        &path.reference
    } else {
        &path.value
    };
    values.iter().map(|value| factor * value).collect()
}

type Points<'a> = &'a dyn Fn(&Tracked, &[f64], bool) -> Vec<[f64; 2]>;

/// Curves of all parts, with their numbers, and the reference, which is the same for all.
fn curves(
    parts: &[DisturbedLoop],
    place: usize,
    (points, has_reference): (Points<'_>, bool),
) -> Vec<Value> {
    let mut out = Vec::new();
    let mut add = |curve: Series, size: Option<usize>| {
        let mut value = series(&curve);
        value["size"] = size.into();
        out.push(value);
    };
    for (size, part) in parts.iter().enumerate() {
        let open = part.closed.open_loop.as_ref().map(|open| &*open.times);
        let open = open.zip(part.closed.tracked_open.get(place));
        if let Some((times, tracked)) = open {
            let points = points(tracked, times, false);
            add(
                Series::curve("without feedback", points, style::MUTED),
                Some(size),
            );
        }
        if let Some(tracked) = part.closed.tracked.get(place) {
            let points = points(tracked, &part.times, false);
            let mut curve = Series::curve("with feedback", points, style::hue(0));
            curve.width = 2.0;
            add(curve, Some(size));
        }
    }
    if has_reference {
        // A motion that ended early has a part of it.
        let longest = parts.iter().max_by_key(|part| part.times.len());
        if let Some(part) = longest {
            let points = points(&part.closed.tracked[place], &part.times, true);
            let curve = Series::curve("reference", points, style::INK);
            add(curve.dashed(Dash::Dashed), None);
        }
    }
    out
}

fn panel(title: &str, axes: [&str; 2], is_equal: bool, curves: Vec<Value>) -> Value {
    let [x, y] = axes.map(|label| axis(label, Scale::Linear));
    json!({ "title": title, "x": x, "y": y, "equal": is_equal, "series": curves })
}
