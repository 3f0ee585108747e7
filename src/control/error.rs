//! Errors of control problems that are not well posed.

use crate::dynamics::{BeyondLaw, EquilibriumError};
use crate::model::ModelError;
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
    /// A given configuration is not at rest under its voltages.
    #[error(
        "{place}: the given joint coordinates do not fit the loops of the scene: {name} is violated by {value:.3e}"
    )]
    Inconsistent {
        /// `start` or `goal`.
        place: &'static str,
        /// The worst constraint.
        name: String,
        /// Its value.
        value: f64,
    },
    /// A state that is that of a goal only.
    #[error(
        "{place}: a motion starts at joint coordinates, at rest under voltages, or at the end of another motion; free and periodic states and places of markers are goals"
    )]
    NoStart {
        /// `start`.
        place: &'static str,
    },
    /// The rates of joints and bodies do not fit a closed loop.
    #[error(
        "{place}: the rates of joints and bodies open a closed loop, by {constraint}; leave out those that follow from the others, or name them all"
    )]
    OpenRates {
        /// `start`.
        place: &'static str,
        /// The constraint that they violate most.
        constraint: String,
    },
    /// A body cannot be given a velocity.
    #[error("{place}: the motion of body \"{body}\" follows from its joints")]
    Follows {
        /// `start`.
        place: &'static str,
        /// The body.
        body: String,
    },
    /// A start or goal contradicts a prescribed motion.
    #[error("{place}: {reason}")]
    Prescribed {
        /// `start` or `goal`.
        place: &'static str,
        /// The joint, what is prescribed and what was found.
        reason: String,
    },
    /// Another motion did not end in a state of this model.
    #[error("{place}.end_of: {reason}")]
    OtherEnd {
        /// `start`.
        place: &'static str,
        /// Difference.
        reason: String,
    },
    /// The inputs that hold a goal cannot be sought.
    #[error("goal.hold: {reason}")]
    Hold {
        /// Reason.
        reason: String,
    },
    /// The ends of a muscle meet in a given configuration.
    #[error("{place}: the ends of muscle \"{muscle}\" meet there, where it has no energy")]
    NoLength {
        /// `start` or `goal`.
        place: &'static str,
        /// The muscle.
        muscle: String,
    },
    /// A muscle or block is beyond the limit of its law in a given configuration.
    #[error("{place}: {part}")]
    BeyondLaw {
        /// `start` or `goal`.
        place: &'static str,
        /// The muscle or block.
        part: BeyondLaw,
    },
    /// A parameter cannot be sought.
    #[error("free parameter \"{name}\": {reason}")]
    Parameter {
        /// Its name.
        name: String,
        /// Reason.
        reason: String,
    },
    /// Known values of the start or the goal break a limit.
    #[error("{place}: {reason}")]
    Limit {
        /// `start` or `goal`, `limits` that contradict each other or that nothing can keep, or the `objective`.
        place: &'static str,
        /// The limit, the value and the bound.
        reason: String,
    },
    /// Start and goal cannot be moved in a program that stands.
    #[error("start and goal need another program: {reason}")]
    OtherProgram {
        /// Difference.
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
