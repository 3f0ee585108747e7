//! Hexahedral meshes: nodes, elements, named node sets. Geometry only: no material, no unknown.
//!
//! Meshes come from planes ([`grid`]) or from a file ([`gmsh`]); [`Mesh::check`] says whether elements can be integrated.
//! [`triangulated`]: surfaces of triangles; [`enclosed`]: solids within them.

pub mod enclosed;
pub mod error;
pub mod geometry;
pub mod gmsh;
pub mod grid;
pub mod quality;
pub mod triangulated;

use nalgebra::Vector3;
use std::collections::BTreeMap;

/// Nodes of a hexahedron in the parent cube [−1, 1]³; also the signs of the Gauss points, of which each lies towards a node.
pub const CORNERS: [[f64; 3]; 8] = [
    [-1.0, -1.0, -1.0],
    [1.0, -1.0, -1.0],
    [1.0, 1.0, -1.0],
    [-1.0, 1.0, -1.0],
    [-1.0, -1.0, 1.0],
    [1.0, -1.0, 1.0],
    [1.0, 1.0, 1.0],
    [-1.0, 1.0, 1.0],
];

/// Trilinear hexahedra over shared nodes.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// Places of the nodes in mm.
    pub nodes: Vec<Vector3<f64>>,
    /// Nodes of each hexahedron: the lower face counter-clockwise seen from above, then the upper face above it, which is
    /// the order of VTK and Gmsh.
    pub hexahedra: Vec<[usize; 8]>,
    /// Region (a part with one material) of each hexahedron, an index into `region_names`.
    pub regions: Vec<usize>,
    /// Names of the regions.
    pub region_names: Vec<String>,
    /// Nodes by the name of a face or set, ascending.
    pub sets: BTreeMap<String, Vec<usize>>,
}
