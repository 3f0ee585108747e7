//! Conversion of a marker of a scene file to a point of a body, or to the node of a block.

use nalgebra::Vector3;

use crate::files::json::error::SceneError;
use crate::files::json::scope::Scope;
use crate::files::scene::names::{attachment, names};
use crate::files::scene::nodes::place;
use crate::files::scene::point::vector;
use crate::files::scene::spec::MarkerSpec;
use crate::mesh::Mesh;
use crate::model::system::{Attachment, Marker, Solid};

/// The marker that is written.
pub(crate) fn marker(
    spec: &MarkerSpec,
    bodies: &[String],
    solids: &[Solid],
    scope: &Scope<'_>,
) -> Result<Marker, SceneError> {
    scope.exactly_one([
        ("body", spec.body.as_ref().map(|_| ())),
        ("solid", spec.solid.as_ref().map(|_| ())),
    ])?;
    let name = spec.name.clone();
    let Some(solid) = &spec.solid else {
        let body = spec.body.as_deref().unwrap_or_default();
        return Ok(Marker {
            name,
            point: attachment(body, &spec.at, bodies, scope)?,
            solid: None,
        });
    };
    let all = names(solids, |solid| &solid.name);
    let solid = scope
        .key("solid")
        .find(solid, &all, "the name of a block")?;
    let at = vector(&spec.at);
    let mesh = &solids[solid].mesh;
    let (node, distance) = nearest(mesh, &at);
    if distance.is_nan() || distance > size_at(mesh, node) {
        let found = format!(
            "{}, which is {distance:.3} mm away from the nearest node, at {}",
            place(&at),
            place(&mesh.nodes[node])
        );
        let expected = "a place no farther from the block than the size of an element";
        return Err(scope.key("at").wrong(found, expected));
    }
    Ok(Marker {
        name,
        point: Attachment { body: None, at },
        solid: Some(solid),
    })
}

/// The node nearest to a place, and its distance in mm.
fn nearest(mesh: &Mesh, at: &Vector3<f64>) -> (usize, f64) {
    let distances = mesh.nodes.iter().map(|node| (node - at).norm());
    let nearest = distances
        .enumerate()
        .min_by(|(_, a), (_, b)| a.total_cmp(b));
    nearest.expect("a checked mesh has nodes")
}

/// The longest edge in mm of the elements at a node.
fn size_at(mesh: &Mesh, node: usize) -> f64 {
    const EDGES: [[usize; 2]; 12] = [
        [0, 1],
        [1, 2],
        [2, 3],
        [3, 0],
        [4, 5],
        [5, 6],
        [6, 7],
        [7, 4],
        [0, 4],
        [1, 5],
        [2, 6],
        [3, 7],
    ];
    let around = mesh
        .hexahedra
        .iter()
        .filter(|corners| corners.contains(&node));
    around
        .flat_map(|corners| EDGES.map(|[a, b]| mesh.nodes[corners[a]] - mesh.nodes[corners[b]]))
        .map(|edge| edge.norm())
        .fold(0.0, f64::max)
}
