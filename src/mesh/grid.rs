//! Structured boxes: hexahedra between node planes along x, y and z.

use crate::math::refuse;
use crate::mesh::Mesh;
use crate::mesh::error::{MeshError, MeshPlace};
use nalgebra::Vector3;
use std::collections::BTreeMap;

const AXES: [char; 3] = ['x', 'y', 'z'];

/// A box cut by planes.
#[derive(Clone, Debug, PartialEq)]
pub struct Grid {
    /// Coordinates in mm of the node planes along x, y and z, ascending, two or more per direction.
    pub planes: [Vec<f64>; 3],
}

impl Grid {
    /// A box of equal elements, lengths in mm: plane i of n is `origin + L i / n`, the last one `origin + L`.
    pub fn uniform(origin: Vector3<f64>, size: Vector3<f64>, elements: [usize; 3]) -> Self {
        let planes = [0, 1, 2].map(|axis| planes(origin[axis], &[(size[axis], elements[axis])]));
        Self { planes }
    }

    /// A box of layers, lengths in mm: along each direction layers `(thickness, elements)` from the lower side to the
    /// upper, whose thicknesses sum to the size (to 1e-9 of it); planes are equally spaced within a layer.
    ///
    /// # Errors
    /// Thicknesses do not sum to the size.
    pub fn layers(
        origin: Vector3<f64>,
        size: Vector3<f64>,
        per_direction: [Vec<(f64, usize)>; 3],
    ) -> Result<Self, MeshError> {
        let mut grid = Self {
            planes: Default::default(),
        };
        for (axis, layers) in per_direction.iter().enumerate() {
            for &(thickness, elements) in layers {
                let fills = thickness > 0.0 && thickness.is_finite() && elements > 0;
                refuse!(if !fills, MeshPlace::Layers(AXES[axis]);
                    found format!("a layer of {thickness} mm in {elements} elements"),
                    expected "a positive thickness in one or more elements");
            }
            let sum = layers
                .iter()
                .fold(0.0, |sum, &(thickness, _)| sum + thickness);
            let fits = (sum - size[axis]).abs() <= 1e-9 * size[axis];
            refuse!(if !fits, MeshPlace::Layers(AXES[axis]);
                found format!("thicknesses that sum to {sum} mm"),
                expected format!("{} mm, the size of the box", size[axis]));
            grid.planes[axis] = planes(origin[axis], layers);
            if let Some(last) = grid.planes[axis].last_mut() {
                *last = origin[axis] + size[axis];
            }
        }
        Ok(grid)
    }

    /// The hexahedra of the box, of one region `box`: nodes and elements count along x first, then y, then z; the sides
    /// are the sets `x_min`, `x_max`, `y_min`, `y_max`, `z_min` and `z_max`.
    pub fn mesh(&self) -> Mesh {
        let [n_x, n_y, n_z] = [0, 1, 2].map(|axis| self.planes[axis].len());
        let node = |x: usize, y: usize, z: usize| x + n_x * (y + n_y * z);
        let nodes = triples([n_x, n_y, n_z])
            .map(|[x, y, z]| Vector3::new(self.planes[0][x], self.planes[1][y], self.planes[2][z]))
            .collect();
        let hexahedra: Vec<_> = triples([n_x, n_y, n_z].map(|planes| planes.saturating_sub(1)))
            .map(|[x, y, z]| {
                let lower = [(x, y), (x + 1, y), (x + 1, y + 1), (x, y + 1)];
                let corner = |i: usize| {
                    let (x, y) = lower[i % 4];
                    node(x, y, z + i / 4)
                };
                std::array::from_fn(corner)
            })
            .collect();
        Mesh {
            nodes,
            regions: vec![0; hexahedra.len()],
            region_names: vec!["box".to_owned()],
            hexahedra,
            sets: sides([n_x, n_y, n_z]),
            ..Mesh::default()
        }
    }
}

/// Planes of layers from a place on; the first plane of a layer is the last one of the layer before.
fn planes(origin: f64, layers: &[(f64, usize)]) -> Vec<f64> {
    let mut planes = vec![origin];
    let mut below = 0.0;
    for &(thickness, elements) in layers {
        let inner = (1..elements).map(|i| below + thickness * i as f64 / elements as f64);
        planes.extend(inner.map(|height| origin + height));
        below += thickness;
        if elements > 0 {
            planes.push(origin + below);
        }
    }
    planes
}

/// Nodes of the six sides, ascending.
fn sides(planes: [usize; 3]) -> BTreeMap<String, Vec<usize>> {
    let mut sets = BTreeMap::new();
    for (axis, name) in AXES.into_iter().enumerate() {
        for (side, plane) in [("min", 0), ("max", planes[axis].saturating_sub(1))] {
            let places = triples(planes).enumerate();
            let nodes = places.filter(|(_, place)| place[axis] == plane);
            sets.insert(
                format!("{name}_{side}"),
                nodes.map(|(node, _)| node).collect(),
            );
        }
    }
    sets
}

/// All (x, y, z) below the counts, x fastest.
fn triples([n_x, n_y, n_z]: [usize; 3]) -> impl Iterator<Item = [usize; 3]> {
    (0..n_z).flat_map(move |z| (0..n_y).flat_map(move |y| (0..n_x).map(move |x| [x, y, z])))
}

impl Mesh {
    /// Places of the node planes along the edges of a box from its first node on, where the mesh is a box grid whose nodes count along one
    /// edge first, then along the second and the third.
    pub fn box_planes(&self) -> Option<[Vec<f64>; 3]> {
        let [origin, x, _, y, z, ..] = *self.hexahedra.first()?;
        let steps = [x, y, z].map(|node| node.checked_sub(origin));
        let [Some(1), Some(n_x), Some(n_xy)] = steps else {
            return None;
        };
        let whole =
            |all: usize, part: usize| (part > 0 && all.is_multiple_of(part)).then(|| all / part);
        let counts = [n_x, whole(n_xy, n_x)?, whole(self.nodes.len(), n_xy)?];
        let cells: usize = counts.iter().map(|count| count.saturating_sub(1)).product();
        if origin != 0 || cells != self.element_count() {
            return None;
        }
        let [cells_x, cells_y] = [counts[0] - 1, counts[1] - 1];
        let mut cells = self.hexahedra.iter().enumerate();
        let are_cells = cells.all(|(cell, nodes)| {
            let [i, j, k] = [
                cell % cells_x,
                cell / cells_x % cells_y,
                cell / (cells_x * cells_y),
            ];
            let first = i + n_x * j + n_xy * k;
            let lower = [first, first + 1, first + 1 + n_x, first + n_x];
            nodes[..4] == lower && nodes[4..] == lower.map(|node| node + n_xy)
        });
        if !are_cells {
            return None;
        }
        let strides = [1, n_x, n_xy];
        Some([0, 1, 2].map(|axis| {
            let node = |plane: usize| self.nodes[plane * strides[axis]];
            let mut place = 0.0;
            let mut planes = vec![0.0];
            for plane in 1..counts[axis] {
                place += (node(plane) - node(plane - 1)).norm();
                planes.push(place);
            }
            planes
        }))
    }
}

/// Tetrahedra around the diagonal of a hexahedron, which cut opposite faces alike.
const IN_HEXAHEDRON: [[usize; 4]; 6] = [
    [0, 1, 2, 6],
    [0, 2, 3, 6],
    [0, 3, 7, 6],
    [0, 7, 4, 6],
    [0, 4, 5, 6],
    [0, 5, 1, 6],
];

impl Mesh {
    /// The mesh with each hexahedron of a grid cut into six tetrahedra with straight edges. The middle of an edge is in the sets of both ends.
    pub fn in_tetrahedra(mut self) -> Self {
        let hexahedra = std::mem::take(&mut self.hexahedra);
        let parts = hexahedra
            .iter()
            .flat_map(|nodes| IN_HEXAHEDRON.map(|corners| corners.map(|corner| nodes[corner])));
        let corners: Vec<_> = parts.collect();
        let first = self.nodes.len();
        let (tetrahedra, edges) = self.raise(&corners);
        self.tetrahedra = tetrahedra;
        for set in self.sets.values_mut() {
            let mut is_in = vec![false; first];
            set.iter().for_each(|&node| is_in[node] = true);
            let middles = edges.iter().enumerate();
            let middles = middles.filter(|(_, ends)| ends.iter().all(|&end| is_in[end]));
            set.extend(middles.map(|(middle, _)| first + middle));
        }
        let regions = self.regions.iter();
        self.regions = regions.flat_map(|&region| [region; 6]).collect();
        self
    }
}
