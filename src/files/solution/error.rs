//! Errors of a file that is no solution of a scene.

use std::io;
use std::path::PathBuf;

use crate::files::npz::NpzError;

/// An earlier solution cannot be used.
#[derive(Debug, thiserror::Error)]
#[error("{}: {reason}", path.display())]
pub struct SolutionError {
    /// The file.
    pub path: PathBuf,
    /// Reason.
    pub reason: Reason,
}

/// Reason why a file is no solution of a scene.
#[derive(Debug, thiserror::Error)]
pub enum Reason {
    /// It cannot be read.
    #[error("cannot be read: {0}")]
    Unreadable(io::Error),
    /// There is not enough memory for its contents.
    #[error("found {found}, expected {expected}")]
    TooLarge {
        /// Its size.
        found: String,
        /// The largest one.
        expected: String,
    },
    /// It is not JSON.
    #[error("no JSON: {0}")]
    NoJson(serde_json::Error),
    /// It is JSON, but no solution.
    #[error(
        "{place}: {found}; a solution.json holds \"time\", \"voltages\", and joint coordinates in \"configuration\" or \"joints\""
    )]
    NoSolution {
        /// Path in the file.
        place: String,
        /// Value that was found there.
        found: String,
    },
    /// Its names are not those of the scene.
    #[error("belongs to another scene: {0}")]
    OtherScene(String),
    /// Its arrays cannot be used.
    #[error("its arrays in {}: {cause}", path.display())]
    Arrays {
        /// Their file.
        path: PathBuf,
        /// Cause.
        cause: NpzError,
    },
    /// Its arrays were written with another file.
    #[error("its arrays in {} were written with another solution", .0.display())]
    OtherArrays(PathBuf),
    /// Its parts do not fit together.
    #[error("{0}")]
    Contradiction(String),
}
