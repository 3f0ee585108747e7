//! Size of a robot, so that a length in the wrong unit shows.

use nalgebra::Vector3;

use crate::mesh::triangulated::Surface;
use crate::model::System;
use crate::model::system::Shape;

/// Robots larger than this, in mm, get a question about their unit.
const HUGE: f64 = 5e3;
/// Robots smaller than this, in mm, get a question about their unit.
const TINY: f64 = 0.1;

/// Lower and upper corner in mm of the box around some places; `(+∞, −∞)` for none.
type Corners = (Vector3<f64>, Vector3<f64>);

/// Lines about the size of the robot and of its meshes in the reference configuration.
pub(super) fn lines(system: &System) -> String {
    let all = around(places(system));
    if all.0.x > all.1.x {
        return String::new();
    }
    let mut text = format!("extent of the robot: {}\n", dimensions(all));
    for solid in &system.solids {
        let corners = around(solid.mesh.nodes.iter().copied());
        text.push_str(&format!(
            "extent of {}: {}\n",
            solid.name,
            dimensions(corners)
        ));
    }
    let largest = (all.1 - all.0).max();
    if !(TINY..=HUGE).contains(&largest) {
        let length = match largest > HUGE {
            true => format!("{} m long", rounded(largest / 1e3)),
            false => format!("{} µm long", rounded(largest * 1e3)),
        };
        text.push_str(&format!(
            "note: the robot is {length}; are the units right? A number without a unit is in m, and so is a mesh file without \"unit\"\n"
        ));
    }
    text
}

fn dimensions((lower, upper): Corners) -> String {
    let [x, y, z] = [0, 1, 2].map(|axis| rounded(upper[axis] - lower[axis]));
    let least = 1e-9 * (upper - lower).max();
    let [a, b, c] = [0, 1, 2].map(|axis| match lower[axis] {
        place if place.abs() < least => 0.0,
        place => rounded(place),
    });
    format!("{x} × {y} × {z} mm from ({a}, {b}, {c}) mm")
}

/// Four digits.
fn rounded(value: f64) -> f64 {
    format!("{value:.3e}").parse().unwrap_or(value) + 0.0
}

fn around(places: impl IntoIterator<Item = Vector3<f64>>) -> Corners {
    let start = (
        Vector3::repeat(f64::INFINITY),
        Vector3::repeat(f64::NEG_INFINITY),
    );
    places
        .into_iter()
        .fold(start, |(lower, upper), x| (lower.inf(&x), upper.sup(&x)))
}

/// Corners of boxes around bodies, ends of muscles, joints and nodes.
fn places(system: &System) -> impl Iterator<Item = Vector3<f64>> + '_ {
    let bodies = system.bodies.iter().flat_map(|body| {
        let half = match body.shape {
            Shape::Surface(_) => {
                let mut surface = Surface::default();
                body.shape.add_to(&mut surface, &body.pose());
                let (lower, upper) = surface.bounds();
                return [lower, upper];
            }
            Shape::Cylinder { length, radius } => Vector3::new(radius, radius, 0.5 * length),
            Shape::Box { size } => Vector3::from(size) / 2.0,
            Shape::Sphere { radius } => Vector3::repeat(radius),
            Shape::None => Vector3::zeros(),
        };
        let reach = body.directors.abs() * half;
        [body.centre - reach, body.centre + reach]
    });
    let ends = system.muscles.iter().flat_map(|m| [m.from.at, m.to.at]);
    let joints = system.joints.iter().map(|joint| joint.at);
    let components = system.components.iter();
    let points = components.flat_map(|component| component.points().into_iter().map(|p| p.at));
    let nodes = system
        .solids
        .iter()
        .flat_map(|s| s.mesh.nodes.iter().copied());
    bodies.chain(ends).chain(joints).chain(points).chain(nodes)
}
