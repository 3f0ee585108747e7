//! Distances of markers of elastic blocks from the places where they are written.

use crate::math::shortest;
use crate::model::System;

/// Part of the distance of a node from the origin, or mm, within which a marker is at it.
const AT: f64 = 1e-6;

/// A line for each marker of a block that is not written at a node: it is the nearest one.
pub(crate) fn moved_markers(system: &System) -> Vec<String> {
    let of_blocks = system.markers.iter().filter_map(|marker| {
        let mesh = &system.solids[marker.solid?].mesh;
        let node = mesh.nodes[mesh.nearest_node(&marker.point.at)?];
        let distance = (node - marker.point.at).norm();
        let [x, y, z] = [node.x, node.y, node.z].map(|value| shortest(value + 0.0, 6));
        (distance > AT * node.norm().max(1.0)).then(|| {
            format!(
                "marker {} is the node at [{x} mm, {y} mm, {z} mm], {} mm from the place that is written",
                marker.name,
                shortest(distance, 3)
            )
        })
    });
    of_blocks.collect()
}
