//! Refusals of numbers by which no optimum is differentiated, before one is looked for.

use crate::control::problem::{Control, Varied, VariedOf};
use crate::control::{BoundaryConditions, BoundaryError};
use crate::model::{Coordinates, System};

/// Checks that the optimum of a problem may be differentiated by the numbers that it names.
///
/// # Errors
/// Name of the number and the reason why not.
pub fn check(system: &System, control: &Control) -> Result<(), (String, String)> {
    if control.varied.is_empty() {
        return Ok(());
    }
    let constants = control.varied.iter().filter_map(Varied::parameter);
    let mut held = control.clone();
    held.parameters.extend(constants.cloned());
    let h0 = control.duration.first() / control.intervals as f64;
    let (model, boundary) = match BoundaryConditions::resolve_held(system, &held, h0) {
        Ok(found) => found,
        Err(BoundaryError::Parameter { name, reason }) => return Err((name, reason)),
        // The solve itself tells of other mistakes.
        Err(_) => return Ok(()),
    };
    for varied in &control.varied {
        let reason = match &varied.of {
            VariedOf::Duration => of_duration(system, control, &boundary).map(str::to_owned),
            VariedOf::StartJoint(_) if remembers(system) => Some(
                "the memory of Maxwell branches at the start follows it, which is not offered"
                    .to_owned(),
            ),
            VariedOf::StartJoint(_) if model.coordinates == Coordinates::Redundant => {
                Some("it is offered in joint coordinates, without constraints, alone".to_owned())
            }
            _ => None,
        };
        if let Some(reason) = reason {
            return Err((varied.name.clone(), reason));
        }
    }
    Ok(())
}

/// The reason why the derivative by a given duration is not known, if there is one.
fn of_duration(
    system: &System,
    control: &Control,
    boundary: &BoundaryConditions,
) -> Option<&'static str> {
    let given = control.given.values().all(|signal| signal.is_constant());
    let moves = system.joints.iter().any(|joint| joint.motion.is_some());
    let is_function = control.course.is_some() || !given || moves;
    let mut limits = boundary.limits.list.iter();
    let is_rate = limits.any(|one| {
        let quantity = &one.quantity;
        one.rate.is_some() || quantity.is_step() || quantity.before().is_some()
    });
    match (is_function, is_rate) {
        (true, _) => Some("given functions of time do not stretch with it, which is not offered"),
        (_, true) => {
            Some("limits of rates, currents or reactions count time by it, which is not offered")
        }
        _ => None,
    }
}

/// Returns true if a material has Maxwell branches.
fn remembers(system: &System) -> bool {
    let of_muscles = system.muscles.iter().map(|muscle| &muscle.material);
    let of_blocks = system.solids.iter().flat_map(|solid| &solid.materials);
    let mut all = of_muscles.chain(of_blocks);
    all.any(|material| !material.maxwell.list().is_empty())
}

/// A reason why derivatives of an optimum do not exist, or are not known to be right.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum NoSensitivity {
    /// The point is none at which the conditions of an optimum hold.
    #[error("the conditions of an optimum hold up to {0:.1e} only: solve with a smaller tolerance")]
    NotOptimal(f64),
    /// A bound that counts as reached pushes the wrong way, or one that counts as free is violated.
    #[error("it is not known whether {0} is reached: solve with a smaller tolerance")]
    Undecided(String),
    /// The matrix is singular.
    #[error(
        "the equations and bounds that are reached depend on each other, or the optimum is not unique to second order"
    )]
    Singular,
    /// There are directions along which the objective falls.
    #[error(
        "it is no strict minimum: along {0} independent directions the Lagrangian falls to second order"
    )]
    NoMinimum(usize),
    /// There are more equations and bounds than unknowns.
    #[error("more equations and bounds are reached ({rows}) than there are unknowns ({columns})")]
    Overdetermined {
        /// Equations and limits.
        rows: usize,
        /// Unknowns that no bound holds.
        columns: usize,
    },
    /// The linear system was not solved to the accuracy of numbers.
    #[error("its linear system is solved up to {0:.1e} only")]
    Inexact(f64),
    /// Two ways to the same derivative differ.
    #[error(
        "the derivative of the objective is {0:.9e} by multipliers and {1:.9e} along the change of the optimum"
    )]
    Contradicts(f64, f64),
    /// Something that the derivatives need is not offered.
    #[error("{0}")]
    Refused(String),
}

impl NoSensitivity {
    /// A refusal in words.
    pub(crate) fn refused(reason: impl ToString) -> Self {
        Self::Refused(reason.to_string())
    }
}
