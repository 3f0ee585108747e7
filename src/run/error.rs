//! Why a command gives no answer: the input is wrong, or a file cannot be written.

use std::path::{Path, PathBuf};

use thiserror::Error;

use crate::control::BoundaryError;
use crate::dynamics::EquilibriumError;
use crate::files::SceneError;
use crate::ipopt::{IpoptError, Status};
use crate::report::atomic::WriteError;
use crate::run::solution_file::SolutionError;

/// How a robot that nothing holds starts.
const FLOATS: &str =
    "; a robot that floats starts from its joint angles: \"start\": { \"joint_angles\": {} }";

/// A command ends without an answer.
#[derive(Debug, Error)]
pub enum RunError {
    /// A scene, problem or override is wrong.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// An earlier solution cannot be used.
    #[error(transparent)]
    Solution(#[from] SolutionError),
    /// What a problem asks for does not exist.
    #[error("{}: {place}: {reason}", file.display())]
    Problem {
        /// The problem file as typed.
        file: PathBuf,
        /// Path in it.
        place: String,
        /// Why.
        reason: String,
    },
    /// The input is right, but a start or goal at rest was not found.
    #[error("{}: {place}: {reason}", file.display())]
    NoEquilibrium {
        /// The problem file as typed.
        file: PathBuf,
        /// Path in it.
        place: String,
        /// Why.
        reason: String,
    },
    /// A value typed on the command line is wrong.
    #[error("{option}: {reason}")]
    Option {
        /// The option.
        option: &'static str,
        /// Why.
        reason: String,
    },
    /// One of several starts finds the input wrong.
    #[error("start {start}: {message}")]
    Start {
        /// Its number.
        start: usize,
        /// What it said.
        message: String,
    },
    /// Ctrl-C was pressed, or the time allowed is over, before there was anything to write.
    #[error("stopped before the first result ({})", .0.word().replace('_', " "))]
    Stopped(Status),
    /// A file stands where a new one was to be written.
    #[error("{} exists already and is left as it is; choose another folder", .0.display())]
    Exists(PathBuf),
    /// A file could not be written.
    #[error(transparent)]
    Write(#[from] WriteError),
}

impl RunError {
    /// Exit status of the program: 2 where the input is wrong, 1 where it has no answer, there was no time, or results could not
    /// be kept.
    pub fn exit_status(&self) -> u8 {
        match self {
            Self::Write(_) | Self::Stopped(_) | Self::NoEquilibrium { .. } => 1,
            _ => 2,
        }
    }

    /// The lines of the file around the mistake, marked, where there is such a place.
    pub fn excerpt(&self) -> Option<String> {
        match self {
            Self::Scene(mistake) => mistake.excerpt(),
            _ => None,
        }
    }

    /// Start or goal of a problem that does not exist; `task` is its key in the file.
    pub(super) fn boundary(file: &Path, task: &str, error: &BoundaryError) -> Self {
        let (key, reason) = match error {
            BoundaryError::Model(source) => ("coordinates", source.to_string()),
            BoundaryError::NoEquilibrium {
                source: EquilibriumError::Stopped(status),
                ..
            } => return Self::Stopped(*status),
            BoundaryError::Limit { place, reason } => (*place, reason.clone()),
            BoundaryError::NoEquilibrium { place, source } => {
                let reason = source.to_string();
                // What nothing holds is wrong input; loads that a robot does not bear are not.
                let is_borne = !matches!(
                    source,
                    EquilibriumError::LimitPoint { .. } | EquilibriumError::NoStart
                );
                if !is_borne {
                    return Self::NoEquilibrium {
                        file: file.to_owned(),
                        place: format!("{task}.{place}"),
                        reason,
                    };
                }
                let floats = match source {
                    EquilibriumError::Singular { redundant, .. } => redundant.is_empty(),
                    EquilibriumError::NoStiffness(_) => true,
                    _ => false,
                };
                let hint = match *place == "start" && floats {
                    true => FLOATS,
                    false => "",
                };
                (*place, reason + hint)
            }
            BoundaryError::Inconsistent { place, .. }
            | BoundaryError::NoLength { place, .. }
            | BoundaryError::Follows { place, .. } => {
                let text = error.to_string();
                let reason = text.strip_prefix(&format!("{place}: ")).unwrap_or(&text);
                (*place, reason.to_owned())
            }
            BoundaryError::Overdetermined { .. } => ("goal", error.to_string()),
        };
        Self::Problem {
            file: file.to_owned(),
            place: format!("{task}.{key}"),
            reason,
        }
    }

    /// An option or a problem that Ipopt does not take.
    pub(super) fn ipopt(file: &Path, error: &IpoptError) -> Self {
        let place = match error {
            IpoptError::OptionRejected { .. } => "control.solver.ipopt",
            IpoptError::ProblemNotCreated { .. } => "control",
        };
        Self::Problem {
            file: file.to_owned(),
            place: place.to_owned(),
            reason: error.to_string(),
        }
    }
}
