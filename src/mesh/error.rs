//! Errors of a mesh or its file: the place, the value found, the value expected.

use nalgebra::Vector3;
use std::fmt;
use thiserror::Error;

/// A mesh that cannot be read or used.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum MeshError {
    /// The operating system does not give the file.
    #[error("{file}: cannot be read: {cause}")]
    Unreadable {
        /// File as the user named it.
        file: String,
        /// Error of the operating system.
        cause: String,
    },
    /// A line of a file is malformed.
    #[error("{file}:{line}: found {found}, expected {expected}")]
    Line {
        /// File as the user named it.
        file: String,
        /// Number of the line, counted from one.
        line: usize,
        /// Value that was found.
        found: String,
        /// Value that is expected instead.
        expected: String,
    },
    /// Layers of a box do not fill it.
    #[error("layers along {axis}: found {found}, expected {expected}")]
    Layers {
        /// Direction of the layers: x, y or z.
        axis: char,
        /// Value that was found.
        found: String,
        /// Value that is expected instead.
        expected: String,
    },
    /// An element cannot be integrated.
    #[error(
        "{element}: found {found}, expected {expected}; its nodes are at {}",
        places(nodes)
    )]
    Element {
        /// The element.
        element: ElementName,
        /// Places in mm of those nodes that exist, in the order of the element.
        nodes: Vec<Vector3<f64>>,
        /// Value that was found.
        found: String,
        /// Value that is expected instead.
        expected: String,
    },
    /// The mesh as a whole is not usable.
    #[error("mesh: found {found}, expected {expected}")]
    Whole {
        /// Value that was found.
        found: String,
        /// Value that is expected instead.
        expected: String,
    },
}

impl MeshError {
    /// An error of the mesh as a whole.
    pub(super) fn whole(found: impl Into<String>, expected: impl Into<String>) -> Self {
        Self::Whole {
            found: found.into(),
            expected: expected.into(),
        }
    }
}

/// Identification of an element.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ElementName {
    /// Index into [`hexahedra`](super::Mesh::hexahedra).
    Index(usize),
    /// Position in a file.
    File {
        /// File as the user named it.
        file: String,
        /// Number of the line, counted from one.
        line: usize,
        /// Number of the element in the file.
        number: u64,
    },
}

impl fmt::Display for ElementName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Index(index) => write!(f, "hexahedron {index}"),
            Self::File { file, line, number } => write!(f, "{file}:{line}: element {number}"),
        }
    }
}

fn places(nodes: &[Vector3<f64>]) -> String {
    let place = |x: &Vector3<f64>| format!("({}, {}, {})", x.x, x.y, x.z);
    nodes.iter().map(place).collect::<Vec<_>>().join(", ")
}
