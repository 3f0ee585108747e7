//! Topology of the elements of a mesh: faces of one element only, connected parts.

use super::Mesh;
use crate::math::DisjointSets;
use std::collections::HashMap;

/// Corners of the six faces of a hexahedron, counter-clockwise seen from outside: lower, upper, then the sides.
pub const FACES: [[usize; 4]; 6] = [
    [0, 3, 2, 1],
    [4, 5, 6, 7],
    [0, 1, 5, 4],
    [1, 2, 6, 5],
    [2, 3, 7, 6],
    [3, 0, 4, 7],
];

impl Mesh {
    /// Nodes of the faces that belong to one element only, counter-clockwise seen from outside, in the order of the
    /// elements.
    pub fn boundary_quads(&self) -> Vec<[usize; 4]> {
        let faces = || {
            let elements = self.hexahedra.iter();
            elements.flat_map(|nodes| FACES.map(|face| face.map(|corner| nodes[corner])))
        };
        let key = |mut face: [usize; 4]| {
            face.sort_unstable();
            face
        };
        let mut elements: HashMap<[usize; 4], usize> = HashMap::new();
        for face in faces() {
            *elements.entry(key(face)).or_default() += 1;
        }
        faces().filter(|&face| elements[&key(face)] == 1).collect()
    }

    /// Elements of each connected part, ascending, parts by their first element; elements that share a node are connected.
    pub fn parts(&self) -> Vec<Vec<usize>> {
        let mut sets = DisjointSets::new(self.nodes.len());
        for nodes in &self.hexahedra {
            for &node in &nodes[1..] {
                sets.join(nodes[0], node);
            }
        }
        let mut part_of = HashMap::new();
        let mut parts: Vec<Vec<usize>> = Vec::new();
        for (element, nodes) in self.hexahedra.iter().enumerate() {
            let part = *part_of
                .entry(sets.smallest(nodes[0]))
                .or_insert(parts.len());
            if part == parts.len() {
                parts.push(Vec::new());
            }
            parts[part].push(element);
        }
        parts
    }
}
