//! Error of a system that is made by a program.

use thiserror::Error;

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
