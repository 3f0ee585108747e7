//! Errors of an identification: the data or the model do not allow one.

use crate::model::NotSought;
use thiserror::Error;

/// Constants cannot be identified.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum IdentifyError {
    /// A recording that is not offered, has no model or no start, or cannot be simulated.
    #[error("recording \"{recording}\": {reason}")]
    Refused {
        /// The recording.
        recording: String,
        /// Reason.
        reason: String,
    },
    /// A candidate whose readings cannot be predicted.
    #[error("candidate \"{candidate}\": {reason}")]
    Candidate {
        /// The candidate.
        candidate: String,
        /// Reason.
        reason: String,
    },
    /// A constant that cannot be sought.
    #[error("{0}")]
    NotSought(NotSought),
    /// No recording depends on a constant.
    #[error("no recording depends on {name}: nothing that moves reads it")]
    Unread {
        /// The constant.
        name: String,
    },
    /// There are fewer readings than unknowns.
    #[error("{readings} readings for {unknowns} unknowns: expected more readings than unknowns")]
    TooFew {
        /// Number of readings.
        readings: usize,
        /// Number of constants and unknowns of starts.
        unknowns: usize,
    },
    /// Nothing moves in the data.
    #[error(
        "not identifiable: nothing moves in the recordings, whose values are all the same; expected motions that depend on the constants"
    )]
    NothingMoves,
    /// The work was stopped.
    #[error("stopped before there was a result")]
    Stopped,
}

impl IdentifyError {
    /// The same error of a candidate, which computes as a recording does.
    pub(super) fn of_candidate(self) -> Self {
        match self {
            Self::Refused { recording, reason } => Self::Candidate {
                candidate: recording,
                reason,
            },
            other => other,
        }
    }
}
