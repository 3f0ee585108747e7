//! Frame of a figure in space: the outline of the system over the whole motion.

use std::collections::HashSet;

use nalgebra::Vector3;

use crate::dynamics::trajectory::Trajectory;
use crate::mesh::triangulated::circle;
use crate::model::system::System;
use crate::report::body::extent_points;
use crate::report::drawing::lumped;
use crate::report::load_arrows::LoadArrows;
use crate::report::skins::{Skins, shown};
use crate::report::solids::Prism;
use crate::report::ties;

/// Points in mm whose outline is that of all that is seen over a motion.
pub(super) fn points(system: &System, trajectory: &Trajectory, skins: &Skins) -> Vec<Vector3<f64>> {
    let mut points = ground_plate(system);
    let arrows = LoadArrows::new(system, trajectory, skins);
    for k in shown(&trajectory.times, 1) {
        for (body, pose) in system.bodies.iter().zip(&trajectory.poses[k]) {
            points.extend(extent_points(&body.shape, pose));
        }
        for i in lumped(system) {
            points.extend(Prism::muscle(system, trajectory, k, i).corners());
        }
        points.extend(ties::lines(system, trajectory, k).into_iter().flatten());
        let arrow = |(source, load)| arrows.arrow(source, load, k);
        points.extend(arrows.loads().flat_map(arrow));
    }
    points.extend(
        skins
            .list
            .iter()
            .flat_map(|skin| skin.places.iter().flatten()),
    );
    points.extend(trajectory.marks.iter().flatten());
    points
}

/// A motion of one instant, the reference configuration, without joint coordinates and voltages.
pub(super) fn reference(system: &System) -> Trajectory {
    let marks = system.markers.iter().map(|marker| marker.point.at);
    Trajectory {
        times: vec![0.0],
        poses: vec![system.bodies.iter().map(|body| body.pose()).collect()],
        marks: vec![marks.collect()],
        ..Trajectory::default()
    }
}

/// Faces of elastic blocks that the ground holds in all directions, in mm.
pub(super) fn held_faces(system: &System) -> Vec<[Vector3<f64>; 4]> {
    let faces = system.solids.iter().flat_map(|solid| {
        let fixed = solid.supports.iter().filter(|s| s.held == [true; 3]);
        let glued = solid.glued.iter().filter(|glue| glue.body.is_none());
        let nodes = fixed.map(|s| &s.nodes).chain(glued.map(|glue| &glue.nodes));
        let held: HashSet<usize> = nodes.flatten().copied().collect();
        let faces = solid.mesh.boundary_quads().into_iter();
        let faces = faces.filter(move |face| face.iter().all(|node| held.contains(node)));
        faces.map(|face| face.map(|node| solid.mesh.nodes[node]))
    });
    faces.collect()
}

/// A disc in the ground below the points that are held by it, in mm; empty where nothing is.
pub(super) fn ground_plate(system: &System) -> Vec<Vector3<f64>> {
    let muscles = system.muscles.iter().flat_map(|m| [m.from, m.to]);
    let components = system.components.iter().flat_map(|c| c.points());
    let joints = system.joints.iter().filter(|j| j.parent.is_none());
    let held: Vec<_> = muscles
        .chain(components)
        .filter(|point| point.body.is_none())
        .map(|point| point.at)
        .chain(joints.map(|j| j.at))
        .collect();
    if held.is_empty() {
        return vec![];
    }
    let centre = held.iter().sum::<Vector3<f64>>() / held.len() as f64;
    let lowest = held.iter().map(|p| p.y).fold(f64::INFINITY, f64::min);
    let spread = held.iter().map(|p| (p - centre).xz().norm());
    let radius = 1.6 * spread.fold(0.0, f64::max) + 8.0;
    let middle = Vector3::new(centre.x, lowest, centre.z);
    circle(middle, Vector3::x(), Vector3::z(), radius)
}
