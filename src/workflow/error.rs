//! Errors of tasks.

use std::error::Error as StdError;
use std::mem;

use thiserror::Error;

use crate::control::BoundaryError;
use crate::dynamics::EquilibriumError;
use crate::ipopt::IpoptError;
use crate::model::ModelError;
use crate::stop::Stopped;

/// Hint at the start of a robot that nothing holds.
const FLOATS: &str =
    "; a robot that floats starts from its joint angles: \"start\": { \"joint_angles\": {} }";

/// Reason why there is no result; places are paths in the problem, such as `control.goal`.
#[derive(Debug, Error)]
pub enum WorkflowError {
    /// The problem asks for something that does not exist.
    #[error("{place}: {reason}")]
    Problem {
        /// Path in the problem.
        place: String,
        /// Reason.
        reason: String,
    },
    /// The problem is right, but a start or goal at rest was not found.
    #[error("{place}: {reason}")]
    NoEquilibrium {
        /// Path in the problem.
        place: String,
        /// Reason.
        reason: String,
    },
    /// The problem is right, but one that a controller has to solve before it begins was not solved.
    #[error("{place}: {reason}")]
    Unsolved {
        /// Path in the problem.
        place: String,
        /// Reason.
        reason: String,
    },
    /// The earlier solution that a solve starts from cannot be used.
    #[error(transparent)]
    Earlier(Box<dyn StdError + Send + Sync>),
    /// An interruption was asked for, or the time allowed is over, before there was a result.
    #[error("stopped before the first result ({0})")]
    Stopped(#[from] Stopped),
}

impl WorkflowError {
    /// A problem that asks for something that does not exist, at a path in it.
    pub(crate) fn problem(place: impl Into<String>, reason: impl Into<String>) -> Self {
        let (place, reason) = (place.into(), reason.into());
        Self::Problem { place, reason }
    }

    /// Start or goal of a problem that does not exist; `task` is its key in the file.
    pub(crate) fn boundary(task: &str, error: &BoundaryError) -> Self {
        let (key, reason) = match error {
            BoundaryError::Model(source @ ModelError::OpenLoop { .. }) => {
                return Self::problem("scene.joints", source.to_string());
            }
            BoundaryError::Model(source) => ("coordinates", source.to_string()),
            BoundaryError::NoEquilibrium {
                source: EquilibriumError::Stopped(stopped),
                ..
            }
            | BoundaryError::Stopped(stopped) => return (*stopped).into(),
            BoundaryError::Refused { place, reason } => (*place, reason.clone()),
            BoundaryError::NoEquilibrium { place, source } => {
                let reason = source.to_string();
                // What nothing holds is wrong input; loads without an equilibrium are not.
                let is_borne = !matches!(
                    source,
                    EquilibriumError::LimitPoint { .. }
                        | EquilibriumError::NoStart
                        | EquilibriumError::OpenLoop { .. }
                );
                if !is_borne {
                    return Self::NoEquilibrium {
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
            BoundaryError::Parameter { name, reason } => {
                ("free", format!("parameter \"{name}\": {reason}"))
            }
            BoundaryError::Overdetermined(_) => ("goal", error.to_string()),
        };
        Self::problem(format!("{task}.{key}"), reason)
    }

    /// The same of one of several motions: its place in the problem, where it has one, is that of the motion.
    pub(crate) fn of_motion(self, list: &str, name: &str) -> Self {
        let within = |place: String| match place.strip_prefix("control.") {
            Some(rest) if !name.is_empty() => format!("control.{list}.{name}.{rest}"),
            _ => place,
        };
        let mut of_motion = self;
        if let Self::Problem { place, .. } | Self::NoEquilibrium { place, .. } = &mut of_motion {
            *place = within(mem::take(place));
        }
        of_motion
    }

    /// An option or a problem that Ipopt does not take.
    pub(crate) fn ipopt(error: &IpoptError) -> Self {
        let place = match error {
            IpoptError::OptionRejected { .. } => "control.solver.ipopt",
            IpoptError::NoStages(_) | IpoptError::NoRoom | IpoptError::NoThreads => {
                "control.solver.linear_solver"
            }
            IpoptError::ProblemNotCreated { .. } => "control",
        };
        Self::problem(place, error.to_string())
    }
}
