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
    /// More equations than unknowns.
    #[error(
        "the problem is overdetermined: {equations} equations for {unknowns} unknowns. {}; {voltages} voltages are sought in \
         {intervals} intervals. {}",
        asked(*rest, *given, goals), cures(*has_elements, *rest)
    )]
    Overdetermined {
        /// Equality constraints.
        equations: usize,
        /// Free variables.
        unknowns: usize,
        /// Equations of rest at the end.
        rest: usize,
        /// Coordinates that the goal gives.
        given: usize,
        /// Other equations of the goal by name.
        goals: Vec<(String, usize)>,
        /// Voltages that are sought.
        voltages: usize,
        /// Number of intervals.
        intervals: usize,
        /// True if nodes of elements are among the coordinates.
        has_elements: bool,
    },
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

/// Largest number of goals listed.
const TOLD: usize = 6;

/// Lists the parts of the goal with their numbers of equations.
fn asked(rest: usize, given: usize, goals: &[(String, usize)]) -> String {
    let mut parts = Vec::new();
    if rest > 0 {
        parts.push(format!("rest at the end is {rest} equations"));
    }
    if given > 0 {
        parts.push(format!("the goal gives {given} coordinates"));
    }
    let told = goals.iter().take(TOLD);
    parts.extend(told.map(|(name, count)| format!("{name} is {count}")));
    if goals.len() > TOLD {
        parts.push(format!("and {} more conditions", goals.len() - TOLD));
    }
    parts.join(", ")
}

/// Returns the changes that make them fewer.
fn cures(has_elements: bool, rest: usize) -> &'static str {
    match has_elements && rest > 0 {
        true => {
            "A few voltages cannot bring every node to rest: write \"rest\": \"bodies\" in the goal, so that bodies and the markers of the goal rest, \
             with \"hold\" for the voltages that are held afterwards; or take fewer final conditions or more intervals"
        }
        false => "Take fewer final conditions, more intervals or more muscles",
    }
}
