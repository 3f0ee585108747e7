//! Mistakes in a URDF file.

use thiserror::Error;

/// A mistake in a URDF file.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
#[error("{place}: found {found}, expected {expected}")]
pub struct UrdfError {
    /// File, with the line where it is known.
    pub place: String,
    /// Value that was found.
    pub found: String,
    /// Value that is expected instead.
    pub expected: String,
}
