//! Errors of the construction of a model.

use thiserror::Error;

/// A system does not permit the analysis.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum ModelError {
    /// Reduced coordinates need a tree.
    #[error(
        "reduced coordinates need joints that form a tree, but joint \"{joint}\" closes a loop; choose \"coordinates\": \"redundant\""
    )]
    NoTree {
        /// The joint that closes a loop.
        joint: String,
    },
    /// An element has no volume, or is inverted.
    #[error("element {element} of block \"{solid}\" is inverted or degenerate")]
    Inverted {
        /// The block.
        solid: String,
        /// The element.
        element: usize,
    },
}
