//! Comparison of the meshes of an earlier motion with those of a model.

use crate::math::Vector;
use crate::model::Model;
use std::collections::BTreeMap;

/// Places that differ by no more than this part of the size of a mesh are one: a file has other units.
const SAME_PLACE: f64 = 1e-9;

/// The first solid of a model whose nodes differ from the given ones: reference places in mm by the name of a solid.
pub(super) fn other_mesh<'m>(
    model: &'m Model,
    told: &BTreeMap<String, Vec<[f64; 3]>>,
) -> Option<&'m str> {
    let mut solids = model.solids.iter().map(|block| &block.solid);
    let other = solids.find(|solid| {
        let nodes = &solid.mesh.nodes;
        let tolerance = SAME_PLACE * solid.mesh.size();
        let apart = |a: [f64; 3], b: &Vector| (Vector::from(a) - b).amax();
        told.get(&solid.name).is_some_and(|told| {
            let mut places = told.iter().zip(nodes);
            told.len() != nodes.len() || places.any(|(&a, b)| apart(a, b) > tolerance)
        })
    });
    other.map(|solid| solid.name.as_str())
}
