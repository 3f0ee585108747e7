//! The reason why there is no controller with a receding horizon.

use crate::ipopt::Status;
use crate::workflow::error::WorkflowError;
use crate::workflow::regulator::NoRegulator;
use std::fmt;

/// Reason why there is no controller with a receding horizon.
#[derive(Clone, Debug, PartialEq)]
pub enum NoHorizon {
    /// There is no regulator of the motion, whose costs it takes.
    Regulator(NoRegulator),
    /// Nothing holds the goal after the end.
    NotHeld(String),
    /// The program of the horizon does not exist.
    Program(String),
    /// Something of the problem is not offered.
    NotOffered(&'static str),
    /// The problem has no optimum that was found.
    Unsolved(String),
    /// It was time to stop.
    Stopped(Status),
}

impl fmt::Display for NoHorizon {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Regulator(reason) => reason.fmt(f),
            Self::NotHeld(reason) => write!(f, "the goal is not held after the end: {reason}"),
            Self::Program(reason) | Self::Unsolved(reason) => f.write_str(reason),
            Self::Stopped(status) => f.write_str(status.word()),
            Self::NotOffered(what) => {
                write!(f, "{what}, which a receding horizon does not take in")
            }
        }
    }
}

impl std::error::Error for NoHorizon {}

impl NoHorizon {
    /// The same as an error at a place of a problem, with words in front.
    pub(crate) fn at(self, place: &str, words: &str) -> WorkflowError {
        let place = place.to_owned();
        let reason = format!("{words}{self}");
        match self {
            Self::Stopped(status) => WorkflowError::Stopped(status),
            Self::Unsolved(_) => WorkflowError::Unsolved { place, reason },
            _ => WorkflowError::Problem { place, reason },
        }
    }
}
