//! The system in space: its first instant in light grey, its last one coloured by the voltages that hold it; and the motion in a few stills.

use nalgebra::Vector3;

use crate::dynamics::trajectory::Trajectory;
use crate::report::Run;
use crate::report::body::Tint;
use crate::report::canvas::{self, Align};
use crate::report::drawing::{Drawing, marker_colour, points, reference};
use crate::report::legend::{self, LegendSymbol, colour_bar};
use crate::report::skins::Skins;
use crate::report::style;
use crate::report::view::View;

/// Most width and height of the drawing in pt.
const MOST: [f64; 2] = [400.0, 440.0];
/// Margin around the drawing in pt.
const MARGIN: f64 = 22.0;
/// Least width of the column with colour bar and names in pt.
const SIDE: f64 = 112.0;
/// Height of the colour bar with the texts above and below it in pt.
const BAR: f64 = 154.0;
/// Maximum number of markers named.
const NAMED: usize = 12;

/// `configuration.svg`: first and last instant and the path of each marker, framed for the whole motion; muscles are coloured by the
/// voltages that hold the last instant or else by those of the last interval, blocks by the potentials of the last interval.
///
/// A single instant has the reference configuration behind it, and the way from there.
pub fn svg(run: &Run<'_>) -> String {
    let Run {
        system,
        trajectory,
        skins,
        ..
    } = *run;
    let last = trajectory.intervals();
    let at_reference = Run {
        trajectory: &reference(system),
        skins: &Skins::default(),
        ..*run
    };
    let paths = paths(run);
    let mut points = points(run);
    if last == 0 {
        points.extend(self::points(&at_reference));
        points.extend(skins.list.iter().flat_map(|skin| &skin.reference));
    }
    points.extend(paths.iter().flatten());
    let (view, [width, height]) = run.view().fitted(&points, [MARGIN, MARGIN], MOST);
    let (voltages, scale) = match run.held {
        Some(held) => {
            let highest = vec![skins.highest()];
            let voltages = [&held[..system.first_load()], &highest];
            (held.to_vec(), style::voltage_scale(voltages))
        }
        None => (voltages(run, last), run.voltage_scale()),
    };
    let is_charged = is_charged(run);
    let mut drawing = Drawing {
        run: *run,
        view,
        voltages,
        scale,
    };
    let names = names(run);
    let bar = if is_charged { BAR } else { 0.0 };
    let beside = bar + legend::ROW * names.len() as f64 + legend::TRIAD;
    let side = SIDE.max(legend::width(&names) + 22.0);
    let size = [
        width.max(120.0) + 2.0 * MARGIN + side,
        height.max(beside) + 2.0 * MARGIN,
    ];
    // What is flat stands in the middle.
    drawing.view.origin[1] += 0.5 * (size[1] - 2.0 * MARGIN - height);
    canvas::svg(size, run.origin, |canvas| {
        drawing.ground(canvas);
        match last {
            0 => {
                let behind = Drawing {
                    run: at_reference,
                    voltages: Vec::new(),
                    ..drawing
                };
                behind.instant(canvas, 0, Tint::Reference);
                drawing.reference_skins(canvas);
            }
            _ => drawing.instant(canvas, 0, Tint::Reference),
        }
        drawing.instant(canvas, last, Tint::Coloured);
        drawing.paths(canvas, &paths);
        let left = size[0] - side + 14.0;
        let top = MARGIN + 14.0;
        if is_charged {
            colour_bar(canvas, [left, top], scale);
        }
        legend::draw(canvas, [left, top + bar], &names);
        let corner = [left + 22.0, size[1] - MARGIN - 16.0];
        legend::triad(canvas, &drawing.view, corner);
    })
}

/// Returns true if voltages colour anything.
fn is_charged(run: &Run<'_>) -> bool {
    !run.system.muscles.is_empty() || run.skins.list.iter().any(|skin| skin.is_charged)
}

/// Voltages in V of the interval that ends at an instant; zero where there is none.
fn voltages(run: &Run<'_>, instant: usize) -> Vec<f64> {
    let known = run.trajectory.voltages.get(instant.saturating_sub(1));
    let zero = || vec![0.0; run.system.sources().len()];
    known.cloned().unwrap_or_else(zero)
}

/// The path of each marker; to a state of rest through the equilibria on the way, or straight from the reference configuration.
fn paths(run: &Run<'_>) -> Vec<Vec<Vector3<f64>>> {
    let markers = run.system.markers.iter().enumerate();
    let path = markers.map(|(m, marker)| match run.trajectory.intervals() {
        0 => {
            let between = run.equilibria.map_or_else(Vec::new, |way| way.path(m));
            let ends = run.trajectory.path(m);
            [marker.point.at]
                .into_iter()
                .chain(between)
                .chain(ends)
                .collect()
        }
        _ => run.trajectory.path(m),
    });
    path.collect()
}

/// Returns the names of the drawn parts.
fn names(run: &Run<'_>) -> Vec<(String, LegendSymbol)> {
    let Run {
        system,
        trajectory,
        skins,
        ..
    } = *run;
    let last = trajectory.intervals();
    let of_blocks = system.bodies.is_empty();
    let now = match skins.list.first() {
        Some(skin) if of_blocks && skin.is_charged => style::voltage(0.5),
        Some(_) if of_blocks => style::PASSIVE.mix(style::INK, 0.25),
        _ => style::BODY,
    };
    let (before, after) = match last {
        0 => ("reference".to_owned(), "at rest".to_owned()),
        _ => {
            let held = if run.held.is_some() { ", held" } else { "" };
            let [first, end] = [0, last].map(|k| time(trajectory.times[k]));
            (format!("at {first}"), format!("at {end}{held}"))
        }
    };
    let mut rows = vec![
        (before, LegendSymbol::Swatch(style::REFERENCE)),
        (after, LegendSymbol::Swatch(now)),
    ];
    let count = system.markers.len();
    for (m, marker) in system.markers.iter().take(NAMED).enumerate() {
        let what = match (last, run.equilibria) {
            (0, None) => "displacement",
            _ => "path",
        };
        let name = format!("{what} of {}", marker.name);
        rows.push((name, LegendSymbol::Path(marker_colour(m, count))));
    }
    rows
}

/// A time in ms as a text in s.
fn time(milliseconds: f64) -> String {
    let seconds = format!("{:.3}", milliseconds / 1e3);
    format!("{} s", seconds.trim_end_matches('0').trim_end_matches('.'))
}

/// Maximum number of stills.
const STILLS: usize = 6;
/// Most width and height of a still in pt.
const PANEL: [f64; 2] = [190.0, 240.0];
/// Most width of a row in pt.
const ROW_WIDTH: f64 = 800.0;
/// Least distance between stills, and margin of the sheet, in pt.
const GAP: f64 = 16.0;
/// Height of the time below a still in pt.
const LABEL: f64 = 22.0;
/// Width of the column with the colour bar in pt.
const BAR_SIDE: f64 = 100.0;
/// Height of the colour bar with axes and scale in pt.
const BESIDE: f64 = 290.0;

/// `snapshots.svg`: instants at equal distances from the first to the last in one frame, each with the voltages of the interval that ends
/// there and the paths of the markers up to there; none of a single instant.
pub(super) fn snapshots(run: &Run<'_>) -> Option<String> {
    let (system, trajectory) = (run.system, run.trajectory);
    let instants = instants(trajectory, run.skins);
    if instants.len() < 2 {
        return None;
    }
    let (view, [width, height]) = run.view().fitted(&points(run), [0.0, 0.0], PANEL);
    let scale = run.voltage_scale();
    let step = [width.max(40.0) + GAP, height + LABEL + GAP];
    let rows = (instants.len() as f64 * step[0] / ROW_WIDTH).ceil() as usize;
    let columns = instants.len().div_ceil(rows);
    let rows = instants.len().div_ceil(columns);
    let size = [
        2.0 * GAP + columns as f64 * step[0] + BAR_SIDE,
        (2.0 * GAP + rows as f64 * step[1]).max(BESIDE),
    ];
    Some(canvas::svg(size, run.origin, |canvas| {
        for (i, &k) in instants.iter().enumerate() {
            let corner = [
                GAP + (i % columns) as f64 * step[0],
                GAP + (i / columns) as f64 * step[1],
            ];
            let [x, y] = view.origin;
            let view = View {
                origin: [x + corner[0], y + corner[1]],
                ..view
            };
            let drawing = Drawing {
                run: *run,
                view,
                voltages: voltages(run, k),
                scale,
            };
            drawing.ground(canvas);
            drawing.instant(canvas, k, Tint::Coloured);
            let paths = (0..system.markers.len()).map(|m| {
                let path = trajectory.path(m);
                path[..=k].to_vec()
            });
            drawing.paths(canvas, &paths.collect::<Vec<_>>());
            let place = [corner[0] + 0.5 * width, corner[1] + height + 0.6 * LABEL];
            let label = time(trajectory.times[k]);
            canvas.text(place, &label, style::TICK_SIZE, Align::Centre);
        }
        let left = size[0] - BAR_SIDE + GAP;
        if is_charged(run) {
            colour_bar(canvas, [left, GAP + 18.0], scale);
        }
        legend::triad(canvas, &view, [left + 22.0, BESIDE - 2.0 * GAP]);
    }))
}

/// Instants at equal distances in time, of those whose surfaces are known.
fn instants(trajectory: &Trajectory, skins: &Skins) -> Vec<usize> {
    let all: Vec<usize> = match skins.instants[..] {
        [] => (0..trajectory.times.len()).collect(),
        _ => skins.instants.clone(),
    };
    let last = all.len().saturating_sub(1);
    let times = &trajectory.times;
    let nearest = |i: usize| {
        let part = i as f64 / (STILLS - 1) as f64;
        let time = times[all[0]] + part * (times[all[last]] - times[all[0]]);
        let far = |k: &usize| (times[*k] - time).abs();
        all.iter().copied().min_by(|a, b| far(a).total_cmp(&far(b)))
    };
    let mut chosen: Vec<usize> = (0..STILLS).filter_map(nearest).collect();
    chosen.dedup();
    chosen
}
