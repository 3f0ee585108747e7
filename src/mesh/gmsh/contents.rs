//! Contents of a file, by the numbers in it.

use super::lines::Line;
use crate::mesh::error::MeshError;
use nalgebra::Vector3;
use std::collections::BTreeMap;

/// Name of the region of hexahedra that belong to no physical volume.
pub const UNGROUPED: &str = "ungrouped";

/// Number of a physical group by the dimension of its elements; zero is no group.
pub(super) type Group = (usize, u64);

/// An element of a kind that is of use.
pub(super) struct Element {
    pub(super) number: u64,
    /// Number of its line in the file.
    pub(super) line: usize,
    /// 0 point, 1 line, 2 quadrangle, 3 hexahedron.
    pub(super) dimension: usize,
    /// Numbers of its nodes in the file.
    pub(super) nodes: Vec<u64>,
    /// Numbers of the physical groups it belongs to.
    pub(super) groups: Vec<u64>,
}

/// A file as read, by the numbers in it.
#[derive(Default)]
pub(super) struct Contents {
    pub(super) names: BTreeMap<Group, String>,
    pub(super) nodes: BTreeMap<u64, Vector3<f64>>,
    pub(super) elements: Vec<Element>,
    /// Line of `$Elements`.
    pub(super) line: usize,
}

/// Puts a node in, unless there is one of its number.
pub(super) fn insert(
    nodes: &mut BTreeMap<u64, Vector3<f64>>,
    line: &Line<'_>,
    number: u64,
    place: Vector3<f64>,
) -> Result<(), MeshError> {
    match nodes.insert(number, place) {
        None => Ok(()),
        Some(_) => Err(line.error(
            format!("a second node {number}"),
            "a number of its own for each node",
        )),
    }
}
