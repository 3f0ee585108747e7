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
    /// A loop is closed in the reference configuration only.
    #[error(
        "the joints that close loops ({joints}) contradict each other along the motion: places and axes leave a gap of {gap:.1e} (rad, or of the length of the system), expected none; write them with more digits, as all axes of a plane linkage along one direction, or use spherical joints"
    )]
    OpenLoop {
        /// The joints.
        joints: String,
        /// The gap that stays.
        gap: f64,
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

/// A part of a system that makes no sense.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
#[error("{part}: {found}, expected {expected}")]
pub struct SystemError {
    /// Name of the part.
    pub part: String,
    /// Value that was found.
    pub found: String,
    /// Value that was expected.
    pub expected: String,
}

/// Refuses a part unless a condition holds.
pub(super) fn require(
    holds: bool,
    part: &str,
    found: impl FnOnce() -> String,
    expected: &str,
) -> Result<(), SystemError> {
    match holds {
        true => Ok(()),
        false => Err(SystemError {
            part: part.to_owned(),
            found: found(),
            expected: expected.to_owned(),
        }),
    }
}

/// Refuses a value that is not positive and finite.
pub(super) fn positive(part: &str, what: &str, value: f64) -> Result<(), SystemError> {
    let holds = value > 0.0 && value.is_finite();
    require(
        holds,
        part,
        || format!("{what} {value}"),
        "a positive number",
    )
}
