//! Kinds of elements, and their faces.

use super::hexahedron;
use super::tetrahedron;

/// Kind of an element.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Cell {
    /// Trilinear, with 8 nodes.
    Hexahedron,
    /// Quadratic, with 10 nodes.
    Tetrahedron,
    /// Of a membrane, quadratic, with 6 nodes.
    Triangle,
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
            6 => Self::Triangle,
            count => unreachable!("no element has {count} nodes"),
        }
    }

    /// Name of one.
    pub fn name(self) -> &'static str {
        match self {
            Self::Hexahedron => "hexahedron",
            Self::Tetrahedron => "tetrahedron",
            Self::Triangle => "triangle",
        }
    }

    /// Name of several.
    pub fn names(self) -> &'static str {
        match self {
            Self::Hexahedron => "hexahedra",
            Self::Tetrahedron => "tetrahedra",
            Self::Triangle => "triangles",
        }
    }

    /// Places among the nodes of an element of those of each face: its corners, counter-clockwise seen from outside, then the middles of its
    /// edges from the first corner on, where it has any. A triangle is its own face, seen from
    /// the side where a pressure inflates it: along its normal.
    pub fn faces(self) -> &'static [&'static [usize]] {
        match self {
            Self::Hexahedron => &hexahedron::FACES,
            Self::Tetrahedron => &tetrahedron::FACES,
            Self::Triangle => &[&[0, 2, 1, 5, 4, 3]],
        }
    }

    /// Its number among the cells of VTK, which order nodes alike.
    pub fn of_vtk(self) -> u8 {
        match self {
            Self::Hexahedron => 12,
            Self::Tetrahedron => 24,
            Self::Triangle => 22,
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
