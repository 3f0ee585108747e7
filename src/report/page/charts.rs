//! Curves of a page: quantities over time, which its cursor follows, and plots of any other kind.

use serde_json::{Value, json};

use crate::dynamics::trajectory::Column;
use crate::model::system::System;
use crate::report::axes::Scale;
use crate::report::lines::{Aspect, LinePlot, Mark, Series};
use crate::report::page::numbers::numbers;
use crate::report::style::{self, Dash};
use crate::report::{Run, Told, joints, tip_path, tracking, voltages};

/// Panels beyond which voltages are shown as colours.
const PANELS: usize = 12;
/// Most points of a curve.
const POINTS: usize = 2000;

/// All charts of a run, in the order of the page.
pub(super) fn charts(run: &Run<'_>, told: &Told) -> Vec<Value> {
    let mut charts = Vec::new();
    if run.trajectory.times.len() > 1 && run.branch.is_none() {
        charts.extend(of_voltages(run));
        charts.extend(paths(run));
        charts.extend(over_time(run));
    }
    charts.extend(plots(told).into_iter().map(|mut chart| {
        // The path of equilibria has their fraction of the voltages upwards.
        chart["level"] = run.branch.is_some().into();
        chart
    }));
    charts
}

/// What is no function of time.
pub(super) fn plots(told: &Told) -> Vec<Value> {
    let plots = told.plots.iter();
    let chart = |(title, plot): &(String, LinePlot)| json!({ "title": title, "kind": "plot", "panels": [panel("", plot)] });
    plots.map(chart).collect()
}

/// Voltages: the sources between the same two bodies share a panel; many panels become rows of colours.
fn of_voltages(run: &Run<'_>) -> Option<Value> {
    let curves = voltages::curves(run.system, run.trajectory);
    let (mut names, mut groups): (Vec<String>, Vec<Vec<&Series>>) = (Vec::new(), Vec::new());
    for (i, curve) in curves.iter().enumerate() {
        let name = pair(run.system, i);
        match names.iter().position(|other| *other == name) {
            Some(group) => groups[group].push(curve),
            None => {
                names.push(name);
                groups.push(vec![curve]);
            }
        }
    }
    let kind = if groups.len() > PANELS {
        "rows"
    } else {
        "panels"
    };
    let alone = groups.len() == 1;
    let panels = names.iter().zip(&groups).map(|(name, group)| {
        json!({
            "title": if alone { "" } else { name },
            "x": axis("time [s]", Scale::Linear),
            "y": axis("voltage [kV]", Scale::Linear),
            "series": group.iter().map(|one| series(one)).collect::<Vec<_>>(),
        })
    });
    let panels: Vec<Value> = panels.collect();
    (!panels.is_empty())
        .then(|| json!({ "title": "Voltages", "kind": kind, "time": true, "panels": panels }))
}

/// What a source acts on: the joint between the bodies of a muscle, or these; the block of an electrode.
fn pair(system: &System, source: usize) -> String {
    let Some(muscle) = system.muscles.get(source) else {
        let sources = system.sources();
        let name = &sources[source].name;
        return name
            .rsplit_once('.')
            .map_or(name.clone(), |(block, _)| block.to_owned());
    };
    let ends = [muscle.from.body, muscle.to.body];
    let joins = |parent: Option<usize>, child: usize| {
        [[parent, Some(child)], [Some(child), parent]].contains(&ends)
    };
    let joint = system
        .joints
        .iter()
        .find(|joint| joins(joint.parent, joint.child));
    let body = |body: Option<usize>| body.map_or("ground", |b| system.bodies[b].name.as_str());
    match joint {
        Some(joint) => joint.name.clone(),
        None => format!("{} to {}", body(ends[0]), body(ends[1])),
    }
}

/// Quantities over time with a chart each.
fn over_time(run: &Run<'_>) -> Vec<Value> {
    let (system, motion) = (run.system, run.trajectory);
    let times = &motion.times;
    let observed = |chosen: &dyn Fn(&Column) -> Option<String>, factor: f64| {
        let columns = run.observations.columns.iter();
        let named = columns.filter_map(|column| Some((chosen(column)?, column)));
        let curve = |(i, (name, column)): (usize, (String, &Column))| {
            let points = times.iter().zip(&column.values);
            let points = points.map(|(t, v)| [t / 1e3, factor * v]).collect();
            Series::curve(name, points, style::hue(i))
        };
        named.enumerate().map(curve).collect::<Vec<_>>()
    };
    let ends = |end: &'static str| {
        move |column: &Column| Some(column.name.strip_suffix(end)?.replace('_', " "))
    };
    let begins = |start: &'static str| {
        move |column: &Column| Some(column.name.strip_prefix(start)?.to_owned())
    };
    let marker = |column: &Column| {
        let (name, axis) = column.name.rsplit_once('_')?;
        let is = column.unit == "mm" && system.markers.iter().any(|marker| marker.name == name);
        is.then(|| format!("{name} {axis}"))
    };
    let energy =
        |column: &Column| joints::is_energy(&column.name).then(|| column.name.replace('_', " "));
    let source = |end: &'static str| {
        move |column: &Column| {
            let name = column.name.strip_suffix(end)?;
            (column.name != "mechanical_work").then(|| name.replace('_', " "))
        }
    };
    let violation = |column: &Column| {
        (column.name == "constraint_violation").then(|| "constraint violation".to_owned())
    };
    let mut momenta = observed(&begins("angular_momentum_"), 1.0);
    momenta
        .iter_mut()
        .for_each(|series| series.name.insert_str(0, "about "));
    let (charge, charges) = joints::scaled_charges(joints::charges(motion, run.observations));
    let all = [
        (
            "Joints",
            joints::label(system, motion),
            joints::curves(system, motion),
        ),
        ("Markers", "place [mm]", observed(&marker, 1.0)),
        (
            "Deviations",
            tracking::label(run.tracked),
            tracking::curves(times, run.tracked),
        ),
        ("Stretches", "stretch", observed(&ends("_stretch"), 1.0)),
        ("Charges", charge, charges),
        ("Energies", "energy [mJ]", observed(&energy, 1.0)),
        (
            "Energy from each source",
            "energy [mJ]",
            observed(&source("_electrical_energy"), 1.0),
        ),
        (
            "Work of each source",
            "work [mJ]",
            observed(&source("_mechanical_work"), 1.0),
        ),
        (
            "Linear momentum",
            "momentum [N ms]",
            observed(&begins("linear_momentum_"), 1.0),
        ),
        ("Angular momentum", "momentum [N mm ms]", momenta),
        (
            "Constraint violation",
            "violation",
            observed(&violation, 1.0),
        ),
    ];
    let chart = |(title, label, curves): (&str, &str, Vec<Series>)| {
        // What stays zero, such as the violation of constraints that were eliminated, is no curve.
        let mut values = curves.iter().flat_map(|one| &one.points);
        let exists = values.any(|point| point[1].is_finite() && point[1] != 0.0);
        exists.then(|| {
            let curves: Vec<Value> = curves.iter().map(series).collect();
            let panel = json!({
                "title": "",
                "x": axis("time [s]", Scale::Linear),
                "y": axis(label, Scale::Linear),
                "series": curves,
            });
            json!({ "title": title, "kind": "panels", "time": true, "panels": [panel] })
        })
    };
    all.into_iter().filter_map(chart).collect()
}

/// Paths of the markers in the three planes of the axes.
fn paths(run: &Run<'_>) -> Option<Value> {
    let mut motions: Vec<_> = run.comparison.into_iter().collect();
    motions.push((run.name, run.trajectory));
    let planes = [[0, 1], [2, 1], [0, 2]];
    let panels = planes.map(|plane| {
        let plot = tip_path::plot(run.system, &motions, run.tracked, plane);
        let name = format!(
            "{}–{}",
            ["x", "y", "z"][plane[0]],
            ["x", "y", "z"][plane[1]]
        );
        panel(&name, &plot)
    });
    let is_any = !run.system.markers.is_empty();
    is_any.then(|| json!({ "title": "Paths of the markers", "kind": "plot", "panels": panels }))
}

/// A plot with its axes.
fn panel(title: &str, plot: &LinePlot) -> Value {
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
