//! Curves of a page: quantities over time, which its cursor follows, and plots of any other kind.

use serde_json::{Value, json};

use crate::dynamics::trajectory::Column;
use crate::model::system::{InputKind, System};
use crate::report::axes::Scale;
use crate::report::lines::{Aspect, LinePlot, Mark, Series};
use crate::report::page::scene::numbers;
use crate::report::style::Dash;
use crate::report::{Run, curves, tip_path};

/// Panels beyond which voltages are shown as colours.
const PANELS: usize = 12;
/// Most points of a curve.
const POINTS: usize = 2000;

/// Planes in which paths are drawn, horizontal axis first.
pub(super) const PLANES: [[usize; 2]; 3] = [[0, 1], [2, 1], [0, 2]];

/// The charts of a run, in the order of the page.
pub(super) fn charts(run: &Run<'_>) -> Vec<Value> {
    let over_time = |plot| {
        let mut chart = of_plot(plot);
        chart["time"] = true.into();
        chart
    };
    let mut charts: Vec<Value> = run.plots.iter().map(over_time).collect();
    if run.trajectory.times.len() > 1 && run.branch.is_none() {
        for kind in InputKind::ALL {
            charts.extend(of_inputs(run, kind));
        }
        charts.extend(paths(run));
        charts.extend(charts_over_time(run));
    }
    charts
}

/// The chart of a plot with its title.
pub(super) fn of_plot(titled: &(String, LinePlot)) -> Value {
    let (title, plot) = titled;
    json!({ "title": title, "kind": "plot", "panels": [panel("", plot)] })
}

/// Inputs of a kind: the sources between the same two bodies share a panel; many panels become rows of colours.
fn of_inputs(run: &Run<'_>, kind: InputKind) -> Option<Value> {
    let mut groups: Vec<(String, Vec<Series>)> = Vec::new();
    for (i, curve) in curves::inputs(run, kind) {
        let name = pair(run.system, i);
        match groups.iter_mut().find(|(other, _)| *other == name) {
            Some((_, group)) => group.push(curve),
            None => groups.push((name, vec![curve])),
        }
    }
    let shown = match groups.len() > PANELS {
        true => "rows",
        false => "panels",
    };
    let alone = groups.len() == 1;
    let panels = groups.into_iter().map(|(name, group)| {
        let plot = LinePlot::over_time(curves::input_label(kind), group);
        panel(if alone { "" } else { &name }, &plot)
    });
    let panels: Vec<Value> = panels.collect();
    let (_, title) = curves::input_names(kind);
    (!panels.is_empty())
        .then(|| json!({ "title": title, "kind": shown, "time": true, "panels": panels }))
}

/// Returns the parts on which a source acts: the joint between the bodies of a muscle, or these; the block of an electrode.
fn pair(system: &System, source: usize) -> String {
    let Some(muscle) = system.muscles.get(source) else {
        let name = &system.sources()[source].name;
        let block = name.rsplit_once('.').map(|(block, _)| block);
        return block.unwrap_or(name).to_owned();
    };
    let ends = [muscle.from.body, muscle.to.body];
    let joins = |parent: Option<usize>, child: usize| {
        [[parent, Some(child)], [Some(child), parent]].contains(&ends)
    };
    let mut joints = system.joints.iter();
    let joint = joints.find(|joint| joins(joint.parent, joint.child));
    let body = |body: Option<usize>| body.map_or("ground", |b| system.bodies[b].name.as_str());
    match joint {
        Some(joint) => joint.name.clone(),
        None => format!("{} to {}", body(ends[0]), body(ends[1])),
    }
}

/// Quantities over time with a chart each, with a panel for each unit.
fn charts_over_time(run: &Run<'_>) -> Vec<Value> {
    let begins = |column: &Column, start: &str, about: &str| {
        let axis = column.name.strip_prefix(start)?;
        Some(format!("{about}{axis}"))
    };
    let marker = |column: &Column| {
        let (name, axis) = column.name.rsplit_once('_')?;
        let markers = &run.system.markers;
        let is = column.unit == "mm" && markers.iter().any(|marker| marker.name == name);
        is.then(|| format!("{name} {axis}"))
    };
    let violation = |column: &Column| {
        (column.name == "constraint_violation").then(|| "constraint violation".to_owned())
    };
    let linear = curves::named(run, &|column| begins(column, "linear_momentum_", ""));
    let angular = curves::named(run, &|column| begins(column, "angular_momentum_", "about "));
    let alone = |label: &'static str, curves: Vec<Series>| vec![(label, curves)];
    let of_each =
        |title: &'static str, label, end: &str| (title, alone(label, curves::of_sources(run, end)));
    let all = [
        ("Joints", curves::joints(run).panels()),
        ("Markers", alone("place [mm]", curves::named(run, &marker))),
        ("Deviations", curves::deviations(run).panels()),
        of_each("Stretches", "stretch", "_stretch"),
        of_each("Tensions", "tension [N]", "_tension"),
        ("Charges", vec![curves::charges(run)]),
        of_each("Voltages of electrodes", "voltage [V]", "_voltage"),
        of_each("Electric fields", "field [V/µm]", "_field"),
        ("Energies", alone("energy [mJ]", curves::energies(run))),
        of_each(
            "Energy from each source",
            "energy [mJ]",
            "_electrical_energy",
        ),
        of_each("Work of each source", "work [mJ]", "_mechanical_work"),
        (
            "Linear momentum, conserved without ground and weight",
            alone("momentum [N ms]", linear),
        ),
        (
            "Angular momentum, conserved without ground and weight",
            alone("momentum [N mm ms]", angular),
        ),
        (
            "Constraint violation",
            alone("violation", curves::named(run, &violation)),
        ),
    ];
    let each = all.into_iter().filter_map(|(title, panels)| {
        let panels = panels.into_iter();
        let panels = panels.filter_map(|(label, curves)| of_time(label, curves));
        let panels: Vec<Value> = panels.collect();
        let chart = json!({ "title": title, "kind": "panels", "time": true, "panels": panels });
        (!panels.is_empty()).then_some(chart)
    });
    each.collect()
}

/// A panel of curves over time; what stays zero, such as the violation of constraints that were eliminated, has none.
fn of_time(label: &str, curves: Vec<Series>) -> Option<Value> {
    let mut values = curves.iter().flat_map(|one| &one.points);
    let exists = values.any(|point| point[1].is_finite() && point[1] != 0.0);
    exists.then(|| panel("", &LinePlot::over_time(label, curves)))
}

/// Paths of the markers in the three planes of the axes.
fn paths(run: &Run<'_>) -> Option<Value> {
    let panels =
        PLANES.map(|plane| panel(&tip_path::plane_name(plane), &tip_path::plot(run, plane)));
    let is_any = !run.system.markers.is_empty();
    is_any.then(|| json!({ "title": "Paths of the markers", "kind": "plot", "panels": panels }))
}

/// A plot with its axes.
pub(super) fn panel(title: &str, plot: &LinePlot) -> Value {
    json!({
        "title": title,
        "x": axis(&plot.x.label, plot.x.scale),
        "y": axis(&plot.y.label, plot.y.scale),
        "equal": plot.aspect == Aspect::Equal,
        "series": plot.series.iter().map(series).collect::<Vec<_>>(),
    })
}

fn axis(label: &str, scale: Scale) -> Value {
    json!({ "label": label, "log": scale == Scale::Log })
}

fn series(series: &Series) -> Value {
    json!({
        "name": series.name,
        "colour": series.colour.hex(),
        "dashed": series.line == Some(Dash::Dashed),
        "joined": series.line.is_some(),
        "width": series.width,
        "mark": match series.mark {
            Mark::None => "none",
            Mark::Ring => "ring",
            Mark::Disc => "disc",
            Mark::Cross => "cross",
        },
        "labels": series.labels,
        "points": numbers(thinned(&series.points).into_iter().flatten()),
    })
}

/// Of many points those that can be seen: in each of many spans the first, the lowest, the highest and the last, in their order.
fn thinned(points: &[[f64; 2]]) -> Vec<[f64; 2]> {
    if points.len() <= POINTS {
        return points.to_vec();
    }
    let span = (4 * points.len()).div_ceil(POINTS);
    let chosen = points.chunks(span).flat_map(|part| {
        let indices = 0..part.len();
        let by_height = |a: &usize, b: &usize| part[*a][1].total_cmp(&part[*b][1]);
        let (low, high) = (indices.clone().min_by(by_height), indices.max_by(by_height));
        let mut chosen = vec![0, low.unwrap_or(0), high.unwrap_or(0), part.len() - 1];
        chosen.sort_unstable();
        chosen.dedup();
        chosen.into_iter().map(|i| part[i])
    });
    chosen.collect()
}
