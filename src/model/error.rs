//! Why a model or a start cannot be had.

use thiserror::Error;

/// A system does not allow what is asked of it.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum ModelError {
    /// Reduced coordinates need a tree of known joints.
    #[error(
        "reduced coordinates need joints that form a tree of revolute, prismatic and fixed joints, but {reason}; choose \"coordinates\": \"redundant\""
    )]
    NoTree {
        /// What stands in the way.
        reason: String,
    },
    /// An element has no volume, or is turned inside out.
    #[error("element {element} of block \"{solid}\" is inverted or degenerate")]
    Inverted {
        /// The block.
        solid: String,
        /// The element.
        element: usize,
    },
}
