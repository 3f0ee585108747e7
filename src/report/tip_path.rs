//! Paths of the markers in the plane in which they move most, or that of a viewpoint.

use nalgebra::Vector3;

use crate::report::Run;
use crate::report::axes::{Axis, Extent};
use crate::report::curves;
use crate::report::lines::{Aspect, LinePlot, Mark, Series};
use crate::report::style::{self, Dash};
use crate::report::view::corners;

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
pub fn svg(run: &Run<'_>) -> String {
    let motions = run.motions();
    let all = motions.iter().flat_map(|(_, one)| &one.marks);
    let plane = run.figures.view.plane(run.system);
    let plane = plane.unwrap_or_else(|| self::plane(all.flatten()));
    plot(run, plane).svg(run.origin)
}

/// The paths in the plane of two axes, horizontal first.
pub(super) fn plot(run: &Run<'_>, [horizontal, vertical]: [usize; 2]) -> LinePlot {
    let (system, motions) = (run.system, run.motions());
    let flat = |p: &Vector3<f64>| [p[horizontal], p[vertical]];
    let mut series = Vec::new();
    let (mut starts, mut ends) = (Vec::new(), Vec::new());
    for (i, (name, trajectory)) in motions.iter().enumerate() {
        let is_main = i + 1 == motions.len();
        for (j, marker) in system.markers.iter().enumerate() {
            let path: Vec<_> = trajectory.path(j).iter().map(flat).collect();
            let name = match system.markers.len() {
                1 => (*name).to_string(),
                _ => format!("{}, {name}", marker.name),
            };
            let colour = match (is_main, j) {
                (true, _) => style::hue(j),
                (false, 0) => style::MUTED,
                (false, _) => style::hue(j).mix(style::PAPER, 0.5),
            };
            if is_main {
                starts.extend(path.first());
                ends.extend(path.last());
            }
            let width = if is_main { 2.0 } else { 1.0 };
            series.push(Series {
                width,
                ..Series::curve(name, path, colour)
            });
        }
    }
    for marker in &system.markers {
        if let Some(points) = curves::reference(run.tracked, &marker.name, [horizontal, vertical]) {
            let name = match system.markers.len() {
                1 => "reference".to_owned(),
                _ => format!("{}, reference", marker.name),
            };
            let curve = Series::curve(name, points, style::INK);
            series.push(curve.dashed(Dash::Dashed));
        }
    }
    if !run.waypoints.is_empty() {
        let places = run.waypoints.iter().map(|(_, place)| flat(place)).collect();
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
