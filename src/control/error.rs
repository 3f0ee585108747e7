//! Errors of control problems that are not well posed.

use crate::dynamics::EquilibriumError;
use crate::model::{ModelError, Parameter};
use crate::stop::Stopped;
use thiserror::Error;

/// A control problem is not well posed.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum BoundaryError {
    /// The model does not exist in these coordinates.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// A state of rest does not exist.
    #[error("{place}: {source}")]
    NoEquilibrium {
        /// `start` or `goal`.
        place: &'static str,
        /// Reason.
        source: EquilibriumError,
    },
    /// A parameter cannot be sought.
    #[error("free parameter \"{name}\": {reason}")]
    Parameter {
        /// Its name.
        name: String,
        /// Reason.
        reason: String,
    },
    /// A part of the problem is not offered, or contradicts another one.
    #[error("{place}: {reason}")]
    Refused {
        /// Path of the part in the problem.
        place: &'static str,
        /// The value found and the one expected.
        reason: String,
    },
    /// Ctrl-C was pressed, or the time allowed is over, before the problem was built.
    #[error("stopped while the problem was built ({0})")]
    Stopped(#[from] Stopped),
    /// More equations than unknowns: their numbers, and what makes them fewer.
    #[error("the problem is overdetermined: {0}")]
    Overdetermined(String),
}

impl BoundaryError {
    /// That a part of the problem is refused.
    pub(super) fn refused(place: &'static str, reason: impl Into<String>) -> Self {
        let reason = reason.into();
        Self::Refused { place, reason }
    }

    /// That a free parameter is refused.
    pub(super) fn parameter(parameter: &Parameter, reason: impl Into<String>) -> Self {
        Self::Parameter {
            name: parameter.name.clone(),
            reason: reason.into(),
        }
    }
}
