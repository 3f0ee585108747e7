//! The motion in a few stills side by side.

use crate::dynamics::trajectory::Trajectory;
use crate::model::system::System;
use crate::report::body::Tint;
use crate::report::canvas::{self, Align};
use crate::report::drawing::{Drawing, ground_plate, points};
use crate::report::legend::colour_bar;
use crate::report::origin::Origin;
use crate::report::pose::{is_charged, time};
use crate::report::skins::Skins;
use crate::report::view::View;
use crate::report::viewpoint::Viewpoint;
use crate::report::{legend, style};

/// Maximum number of stills.
const MOST: usize = 6;
/// Most width and height of a still in pt.
const PANEL: [f64; 2] = [190.0, 240.0];
/// Most width of a row in pt.
const ROW: f64 = 800.0;
/// Least distance between stills, and margin of the sheet, in pt.
const GAP: f64 = 16.0;
/// Height of the time below a still in pt.
const LABEL: f64 = 22.0;
/// Width of the column with the colour bar in pt.
const SIDE: f64 = 100.0;
/// Height of the colour bar with axes and scale in pt.
const BESIDE: f64 = 290.0;

/// `snapshots.svg`: instants at equal distances from the first to the last in one frame, each with the voltages of the interval that ends
/// there and the paths of the markers up to there; none of a single instant.
pub(super) fn svg(
    system: &System,
    trajectory: &Trajectory,
    skins: &Skins,
    viewpoint: Viewpoint,
    origin: &Origin,
) -> Option<String> {
    let instants = instants(trajectory, skins);
    if instants.len() < 2 {
        return None;
    }
    let view = viewpoint.view(system, trajectory, skins);
    let points = points(system, trajectory, skins);
    let (view, [width, height]) = view.fitted(&points, [0.0, 0.0], PANEL);
    let ground = ground_plate(system);
    let scale = style::voltage_scale(trajectory.voltages(system).chain([&[skins.highest()][..]]));
    let step = [width.max(40.0) + GAP, height + LABEL + GAP];
    let rows = (instants.len() as f64 * step[0] / ROW).ceil() as usize;
    let columns = instants.len().div_ceil(rows);
    let rows = instants.len().div_ceil(columns);
    let size = [
        2.0 * GAP + columns as f64 * step[0] + SIDE,
        (2.0 * GAP + rows as f64 * step[1]).max(BESIDE),
    ];
    Some(canvas::svg(size, origin, |canvas| {
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
            let voltages = trajectory.voltages.get(k.saturating_sub(1));
            let drawing = Drawing {
                system,
                trajectory,
                skins,
                view,
                voltages: voltages
                    .cloned()
                    .unwrap_or_else(|| vec![0.0; system.sources().len()]),
                scale,
            };
            drawing.ground(canvas, &ground);
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
        let left = size[0] - SIDE + GAP;
        if is_charged(system, skins) {
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
        let part = i as f64 / (MOST - 1) as f64;
        let time = times[all[0]] + part * (times[all[last]] - times[all[0]]);
        let far = |k: &usize| (times[*k] - time).abs();
        all.iter().copied().min_by(|a, b| far(a).total_cmp(&far(b)))
    };
    let mut chosen: Vec<usize> = (0..MOST).filter_map(nearest).collect();
    chosen.dedup();
    chosen
}
