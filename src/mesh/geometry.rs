//! Geometry of a mesh: bounds, nodes at a place, rigid placement.

use crate::math::DisjointSets;
use crate::mesh::Mesh;
use nalgebra::Vector3;
use std::collections::HashMap;

impl Mesh {
    /// The mesh with its nodes moved to `map(x)`; a map that mirrors space makes a mesh that
    /// [`check`](Self::check) refuses.
    pub fn transformed(mut self, map: impl FnMut(Vector3<f64>) -> Vector3<f64>) -> Self {
        self.nodes = self.nodes.into_iter().map(map).collect();
        self
    }

    /// Lower and upper corner in mm of the box around all nodes; `(+∞, −∞)` for no nodes.
    pub fn bounds(&self) -> (Vector3<f64>, Vector3<f64>) {
        bounds(&self.nodes)
    }

    /// Diagonal in mm of the box around all nodes; zero for no nodes.
    pub fn size(&self) -> f64 {
        let (lower, upper) = self.bounds();
        if self.nodes.is_empty() {
            0.0
        } else {
            (upper - lower).norm()
        }
    }

    /// Length in mm of the shortest edge of an element; infinite for no elements.
    pub fn shortest_edge(&self) -> f64 {
        let length = |[a, b]: [usize; 2]| (self.nodes[a] - self.nodes[b]).norm();
        let edges = self.hexahedra.iter().flat_map(|nodes| {
            let faces = FACES.into_iter();
            faces
                .flat_map(|face| (0..4).map(move |i| [face[i], face[(i + 1) % 4]]))
                .map(|edge| edge.map(|corner| nodes[corner]))
        });
        edges.map(length).fold(f64::INFINITY, f64::min)
    }

    /// Nodes with `|x_axis − value| ≤ tolerance`, ascending; axes are 0, 1, 2 for x, y, z, lengths in mm.
    pub fn nodes_on_plane(&self, axis: usize, value: f64, tolerance: f64) -> Vec<usize> {
        let nodes = self.nodes.iter().enumerate();
        nodes
            .filter(|(_, x)| (x[axis] - value).abs() <= tolerance)
            .map(|(node, _)| node)
            .collect()
    }

    /// The node nearest to a place in mm, the first of several; none where there are no nodes.
    pub fn nearest_node(&self, place: &Vector3<f64>) -> Option<usize> {
        let distance = |&node: &usize| (self.nodes[node] - place).norm_squared();
        (0..self.nodes.len()).min_by(|a, b| distance(a).total_cmp(&distance(b)))
    }
}

/// Lower and upper corner of the box around points; `(+∞, −∞)` for none.
pub(super) fn bounds(points: &[Vector3<f64>]) -> (Vector3<f64>, Vector3<f64>) {
    let (lower, upper) = (f64::INFINITY, f64::NEG_INFINITY);
    let start = (Vector3::repeat(lower), Vector3::repeat(upper));
    let points = points.iter();
    points.fold(start, |(lower, upper), x| (lower.inf(x), upper.sup(x)))
}

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
