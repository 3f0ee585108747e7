//! Paths of the markers in the plane in which they move most, or that of a viewpoint.

use nalgebra::Vector3;

use crate::dynamics::trajectory::Trajectory;
use crate::model::system::System;
use crate::report::axes::{Axis, Extent};
use crate::report::curves;
use crate::report::lines::{Aspect, LinePlot, Mark, Series};
use crate::report::origin::Origin;
use crate::report::style::{self, Dash};
use crate::report::view::corners;
use crate::report::viewpoint::Viewpoint;
use crate::workflow::Tracked;

/// The two axes of largest extent, horizontal first: y is never horizontal, and x goes before z.
fn plane<'a>(points: impl Iterator<Item = &'a Vector3<f64>>) -> [usize; 2] {
    let finite = points.filter(|p| p.iter().all(|x| x.is_finite()));
    let extent = corners(finite.copied()).map_or_else(Vector3::zeros, |[low, high]| high - low);
    // Among equals the plane x–z is preferred, then x–y.
    let smallest = [1, 2, 0]
        .into_iter()
        .min_by(|&a, &b| extent[a].total_cmp(&extent[b]));
    match smallest {
        Some(0) => [2, 1],
        Some(2) => [0, 1],
        _ => [0, 2],
    }
}

/// `tip_path.svg`: the motion of each marker under each named trajectory, with its start and end, and the places that it was to pass.
///
/// The last trajectory is the one that matters: drawn strong and on top of the others, below what its markers were to follow, dashed.
pub fn svg(
    system: &System,
    trajectories: &[(&str, &Trajectory)],
    tracked: &[Tracked],
    waypoints: &[(usize, Vector3<f64>)],
    view: Viewpoint,
    origin: &Origin,
) -> String {
    let all = trajectories.iter().flat_map(|(_, one)| &one.marks);
    let plane = view.plane().unwrap_or_else(|| plane(all.flatten()));
    plot(system, trajectories, tracked, waypoints, plane).svg(origin)
}

/// The paths in the plane of two axes, horizontal first.
pub(super) fn plot(
    system: &System,
    trajectories: &[(&str, &Trajectory)],
    tracked: &[Tracked],
    waypoints: &[(usize, Vector3<f64>)],
    [horizontal, vertical]: [usize; 2],
) -> LinePlot {
    let paths: Vec<_> = trajectories
        .iter()
        .map(|(name, trajectory)| {
            let markers = 0..system.markers.len();
            let paths: Vec<_> = markers.map(|m| trajectory.path(m)).collect();
            (name, paths)
        })
        .collect();
    let flat = |p: &Vector3<f64>| [p[horizontal], p[vertical]];
    let mut series = Vec::new();
    let (mut starts, mut ends) = (Vec::new(), Vec::new());
    for (i, (name, paths)) in paths.iter().enumerate() {
        let is_main = i + 1 == trajectories.len();
        for (j, (path, marker)) in paths.iter().zip(&system.markers).enumerate() {
            let name = match system.markers.len() {
                1 => (*name).to_string(),
                _ => format!("{}, {name}", marker.name),
            };
            let colour = match (is_main, j) {
                (true, _) => style::hue(j),
                (false, 0) => style::MUTED,
                (false, _) => style::hue(j).mix(style::PAPER, 0.5),
            };
            let mut curve = Series::curve(name, path.iter().map(flat).collect(), colour);
            curve.width = if is_main { 2.0 } else { 1.0 };
            series.push(curve);
            if is_main {
                starts.extend(path.first().map(flat));
                ends.extend(path.last().map(flat));
            }
        }
    }
    for marker in &system.markers {
        if let Some(points) = curves::reference(tracked, &marker.name, [horizontal, vertical]) {
            let name = match system.markers.len() {
                1 => "reference".to_owned(),
                _ => format!("{}, reference", marker.name),
            };
            let curve = Series::curve(name, points, style::INK);
            series.push(curve.dashed(Dash::Dashed));
        }
    }
    if !waypoints.is_empty() {
        let places = waypoints.iter().map(|(_, place)| flat(place)).collect();
        let crosses = Series::curve("to pass", places, style::INK);
        series.push(crosses.marked(Mark::Cross).unjoined());
    }
    for (name, points, mark) in [("start", starts, Mark::Ring), ("end", ends, Mark::Disc)] {
        series.push(
            Series::curve(name, points, style::INK)
                .marked(mark)
                .unjoined(),
        );
    }
    in_plane([horizontal, vertical], series)
}

/// Names of the axes.
const AXES: [&str; 3] = ["x", "y", "z"];

/// Name of a plane, horizontal axis first.
pub(super) fn plane_name(plane: [usize; 2]) -> String {
    plane.map(|axis| AXES[axis]).join("–")
}

/// Curves in a plane, in mm.
pub(super) fn in_plane(plane: [usize; 2], series: Vec<Series>) -> LinePlot {
    let [x, y] = plane.map(|i| Axis::linear(format!("{} [mm]", AXES[i]), Extent::Padded));
    LinePlot {
        aspect: Aspect::Equal,
        frame: [400.0, 300.0],
        ..LinePlot::new(x, y, series)
    }
}
