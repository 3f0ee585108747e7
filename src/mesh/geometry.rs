//! Geometry of a mesh: bounds, nodes at a place, rigid placement.

use crate::math::DisjointSets;
use crate::mesh::Mesh;
use crate::mesh::cell::{Cell, around, corners, flat_parts};
use crate::mesh::tetrahedron::raised;
use nalgebra::Vector3;
use rustc_hash::FxHashMap;
use std::collections::HashMap;

/// Faces of elements by their nodes.
pub type Faces = Vec<Vec<usize>>;

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

    /// Length in mm of the shortest way between two nodes along an edge of an element; infinite for no elements.
    pub fn shortest_edge(&self) -> f64 {
        let lengths = self.elements().flat_map(|nodes| self.edge_lengths(nodes));
        lengths.fold(f64::INFINITY, f64::min)
    }

    /// Lengths in mm of the edges of an element between neighbouring nodes, of each face in turn.
    pub fn edge_lengths(&self, nodes: &[usize]) -> Vec<f64> {
        let faces = Cell::of(nodes).faces().iter();
        let rings = faces.map(|face| around(face));
        let edges = rings
            .flat_map(|ring| (0..ring.len()).map(move |i| [ring[i], ring[(i + 1) % ring.len()]]));
        let ends = edges.map(|ends| ends.map(|end| self.nodes[nodes[end]]));
        ends.map(|[a, b]| (a - b).norm()).collect()
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

impl Mesh {
    /// Nodes of the faces that belong to one element only, in the order of the elements: corners counter-clockwise seen from outside, then the
    /// middles of its edges where it has any.
    pub fn boundary(&self) -> Faces {
        let faces = || {
            let elements = self.elements();
            elements.flat_map(|nodes| {
                Cell::of(nodes)
                    .faces()
                    .iter()
                    .map(move |face| (nodes, *face))
            })
        };
        let key = |of: (&[usize], &[usize])| {
            let (nodes, face) = of;
            let mut key = [usize::MAX; 4];
            for (key, &place) in key.iter_mut().zip(corners(face)) {
                *key = nodes[place];
            }
            key.sort_unstable();
            key
        };
        let mut elements: FxHashMap<[usize; 4], usize> = FxHashMap::default();
        for face in faces() {
            *elements.entry(key(face)).or_default() += 1;
        }
        let alone = faces().filter(|face| elements[&key(*face)] == 1);
        alone
            .map(|(nodes, face)| face.iter().map(|&place| nodes[place]).collect())
            .collect()
    }

    /// The same in flat parts by their corners, as of [`flat_parts`].
    pub fn boundary_quads(&self) -> Vec<[usize; 4]> {
        self.boundary()
            .iter()
            .flat_map(|face| flat_parts(face))
            .collect()
    }

    /// Quadratic tetrahedra or triangles with straight edges that have these corners: adds a node in the middle of each edge. Returns them, and the
    /// ends of the edges in the order of these nodes.
    pub(super) fn raise<const CORNERS: usize, const NODES: usize>(
        &mut self,
        corners: &[[usize; CORNERS]],
    ) -> (Vec<[usize; NODES]>, Vec<[usize; 2]>) {
        let (raised, edges) = raised(corners, self.nodes.len());
        for [a, b] in &edges {
            self.nodes.push(0.5 * (self.nodes[*a] + self.nodes[*b]));
        }
        (raised, edges)
    }

    /// Elements of each connected part, ascending, parts by their first element; elements that share a node are connected.
    pub fn parts(&self) -> Vec<Vec<usize>> {
        let mut sets = DisjointSets::new(self.nodes.len());
        for nodes in self.elements() {
            for &node in &nodes[1..] {
                sets.join(nodes[0], node);
            }
        }
        let mut part_of = HashMap::new();
        let mut parts: Vec<Vec<usize>> = Vec::new();
        for (element, nodes) in self.elements().enumerate() {
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
