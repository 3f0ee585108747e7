//! Meshes of hexahedra, of tetrahedra, or of the triangles of a membrane: nodes, elements, named node sets. Geometry only: no material, no unknown.
//!
//! Meshes come from planes ([`grid`]), from shapes of surfaces ([`surface`]) or from a file ([`gmsh`]); [`Mesh::check`] says whether elements can be integrated.
//! [`footing`]: places on its surface; [`triangulated`]: surfaces of triangles; [`enclosed`]: solids within them.

pub mod cell;
pub mod enclosed;
pub mod error;
pub mod footing;
pub mod geometry;
pub mod gmsh;
pub mod grid;
mod hexahedron;
pub mod interpolation;
pub mod quality;
pub mod surface;
mod tetrahedron;
pub mod triangulated;

use cell::Cell;
pub use hexahedron::CORNERS;
use nalgebra::Vector3;
use std::collections::BTreeMap;

/// Elements of one kind over shared nodes.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// Places of the nodes in mm.
    pub nodes: Vec<Vector3<f64>>,
    /// Nodes of each hexahedron: the lower face counter-clockwise seen from above, then the upper face above it, which is
    /// the order of VTK and Gmsh.
    pub hexahedra: Vec<[usize; 8]>,
    /// Nodes of each quadratic tetrahedron: three corners, counter-clockwise seen from the fourth, then it, then the middles of the edges
    /// 01, 12, 02, 03, 13 and 23, which is the order of VTK.
    pub tetrahedra: Vec<[usize; 10]>,
    /// Nodes of each quadratic triangle of a membrane: three corners, then the middles of the edges 01, 12 and 02, which is the order of VTK.
    pub triangles: Vec<[usize; 6]>,
    /// Region (a part with one material) of each element, an index into `region_names`.
    pub regions: Vec<usize>,
    /// Names of the regions.
    pub region_names: Vec<String>,
    /// Nodes by the name of a face or set, ascending.
    pub sets: BTreeMap<String, Vec<usize>>,
}

impl Mesh {
    /// Number of elements.
    pub fn element_count(&self) -> usize {
        self.hexahedra.len() + self.tetrahedra.len() + self.triangles.len()
    }

    /// Nodes of each element.
    pub fn elements(&self) -> impl Iterator<Item = &[usize]> + Clone {
        let hexahedra = self.hexahedra.iter().map(<[usize; 8]>::as_slice);
        let tetrahedra = self.tetrahedra.iter().map(<[usize; 10]>::as_slice);
        let triangles = self.triangles.iter().map(<[usize; 6]>::as_slice);
        hexahedra.chain(tetrahedra).chain(triangles)
    }

    /// Nodes of an element.
    pub fn element(&self, number: usize) -> &[usize] {
        match self.cell() {
            Cell::Hexahedron => &self.hexahedra[number],
            Cell::Tetrahedron => &self.tetrahedra[number],
            Cell::Triangle => &self.triangles[number],
        }
    }

    /// The kind of its elements.
    pub fn cell(&self) -> Cell {
        match (self.tetrahedra.is_empty(), self.triangles.is_empty()) {
            (true, true) => Cell::Hexahedron,
            (false, _) => Cell::Tetrahedron,
            (true, false) => Cell::Triangle,
        }
    }
}
