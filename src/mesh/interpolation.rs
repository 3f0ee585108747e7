//! Interpolation between the nodes of an element: shape functions N_i(ξ) in a parent cell, points of quadrature, and faces.
//!
//! A kind of element is a file with its shape functions, and a line of [`Cell`]. Formulas have the number of nodes in their types; meshes and
//! pictures ask [`Cell`].

use super::hexahedron::{self, CORNERS};
use super::tetrahedron;

/// A place in a parent cell of so many dimensions, and the weight of a function there.
pub type Point<const DIMENSIONS: usize> = ([f64; DIMENSIONS], f64);

/// Parent cell of the elements and faces with so many nodes.
#[derive(Clone, Copy, Debug)]
pub struct Parent<const NODES: usize>;

/// Shape functions.
pub trait Interpolation<const DIMENSIONS: usize, const NODES: usize> {
    /// N_i.
    fn values(at: &[f64; DIMENSIONS]) -> [f64; NODES];

    /// ∂N_i/∂ξ.
    fn slopes(at: &[f64; DIMENSIONS]) -> [[f64; DIMENSIONS]; NODES];

    /// Points whose sums are exact for products of two shape functions where ∂X/∂ξ is constant.
    fn quadrature() -> Vec<Point<DIMENSIONS>>;
}

/// Shape functions of an element, and the points at which it has its law.
pub trait Element<const NODES: usize>: Interpolation<3, NODES> {
    /// Nodes in the parent cell.
    const PLACES: [[f64; 3]; NODES];
    /// The centre.
    const CENTRE: [f64; 3];
    /// Gauss points.
    const POINTS: [Point<3>; 8];
}

/// Kind of an element.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Cell {
    /// Trilinear, with 8 nodes.
    Hexahedron,
    /// Quadratic, with 10 nodes.
    Tetrahedron,
}

impl Cell {
    /// The kind of an element with these nodes.
    ///
    /// # Panics
    /// There is none with so many.
    pub fn of(nodes: &[usize]) -> Self {
        match nodes.len() {
            8 => Self::Hexahedron,
            10 => Self::Tetrahedron,
            count => unreachable!("no element has {count} nodes"),
        }
    }

    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Hexahedron => "hexahedron",
            Self::Tetrahedron => "tetrahedron",
        }
    }

    /// Places among the nodes of an element of those of each face: its corners, counter-clockwise seen from outside, then the middles of its
    /// edges from the first corner on, where it has any.
    pub fn faces(self) -> &'static [&'static [usize]] {
        match self {
            Self::Hexahedron => &hexahedron::FACES,
            Self::Tetrahedron => &tetrahedron::FACES,
        }
    }

    /// Its number among the cells of VTK, which order nodes alike.
    pub fn of_vtk(self) -> u8 {
        match self {
            Self::Hexahedron => 12,
            Self::Tetrahedron => 24,
        }
    }
}

/// The corners of a face.
pub fn corners(face: &[usize]) -> &[usize] {
    match face.len() {
        6 => &face[..3],
        _ => face,
    }
}

/// Nodes of a face one after the other around it.
pub fn around(face: &[usize]) -> Vec<usize> {
    match *face {
        [a, b, c, ab, bc, ca] => vec![a, ab, b, bc, c, ca],
        _ => face.to_vec(),
    }
}

/// Flat parts of a face by their corners, counter-clockwise seen from outside; of a triangle the last corner is there twice.
pub fn flat_parts(face: &[usize]) -> Vec<[usize; 4]> {
    match *face {
        [a, b, c, d] => vec![[a, b, c, d]],
        [a, b, c, ab, bc, ca] => {
            let corners = [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]];
            corners.map(|[a, b, c]| [a, b, c, c]).to_vec()
        }
        _ => unreachable!("no face has {} nodes", face.len()),
    }
}

/// A bilinear face.
impl Interpolation<2, 4> for Parent<4> {
    fn values(at: &[f64; 2]) -> [f64; 4] {
        std::array::from_fn(|i| 0.25 * factor(i, at, 0) * factor(i, at, 1))
    }

    fn slopes(at: &[f64; 2]) -> [[f64; 2]; 4] {
        let slope = |i: usize, m: usize| 0.25 * CORNERS[i][m] * factor(i, at, 1 - m);
        std::array::from_fn(|i| [0, 1].map(|m| slope(i, m)))
    }

    fn quadrature() -> Vec<Point<2>> {
        // The corners of the square are the first ones of the cube.
        let at = |corner: &[f64; 3]| [corner[0], corner[1]].map(|c| c / 3.0_f64.sqrt());
        CORNERS[..4]
            .iter()
            .map(|corner| (at(corner), 1.0))
            .collect()
    }
}

fn factor(corner: usize, at: &[f64; 2], direction: usize) -> f64 {
    1.0 + CORNERS[corner][direction] * at[direction]
}
