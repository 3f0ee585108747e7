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
    /// Something is not as it is expected.
    #[error("{place}: found {found}, expected {expected}{}", place.nodes())]
    Wrong {
        /// Place of the mistake.
        place: MeshPlace,
        /// Value that was found.
        found: String,
        /// Value that is expected instead.
        expected: String,
    },
}

/// Place of a mistake in a mesh or its file.
#[derive(Clone, Debug, PartialEq)]
pub enum MeshPlace {
    /// The mesh as a whole.
    Whole,
    /// Layers of a box along x, y or z.
    Layers(char),
    /// A line of a file as the user named it, by its number from one.
    Line(String, usize),
    /// An element, and the places in mm of those nodes that exist, in its order.
    Element(ElementName, Vec<Vector3<f64>>),
}

impl MeshPlace {
    /// The error of what is found here.
    pub(crate) fn wrong(self, found: impl Into<String>, expected: impl Into<String>) -> MeshError {
        MeshError::Wrong {
            place: self,
            found: found.into(),
            expected: expected.into(),
        }
    }

    /// The places of nodes, for messages.
    fn nodes(&self) -> String {
        let Self::Element(_, nodes) = self else {
            return String::new();
        };
        let place = |x: &Vector3<f64>| format!("({}, {}, {})", x.x, x.y, x.z);
        let places = nodes.iter().map(place).collect::<Vec<_>>();
        format!("; its nodes are at {}", places.join(", "))
    }
}

impl fmt::Display for MeshPlace {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Whole => f.write_str("mesh"),
            Self::Layers(axis) => write!(f, "layers along {axis}"),
            Self::Line(file, line) => write!(f, "{file}:{line}"),
            Self::Element(element, _) => element.fmt(f),
        }
    }
}

/// Identification of an element.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ElementName {
    /// Kind and number in the mesh.
    Number(&'static str, usize),
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
            Self::Number(kind, number) => write!(f, "{kind} {number}"),
            Self::File { file, line, number } => write!(f, "{file}:{line}: element {number}"),
        }
    }
}
