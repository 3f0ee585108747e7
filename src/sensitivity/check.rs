//! Refusals of numbers by which no optimum is differentiated, before one is looked for.

use crate::control::problem::{Control, Varied};
use crate::control::{BoundaryConditions, BoundaryError};
use crate::model::System;

/// Checks that the optimum of a problem may be differentiated by the numbers that it names.
///
/// # Errors
/// Name of the number and the reason why not.
pub fn check(system: &System, control: &Control) -> Result<(), (String, String)> {
    let constants: Vec<_> = control
        .varied
        .iter()
        .filter_map(Varied::parameter)
        .collect();
    if constants.is_empty() {
        return Ok(());
    }
    let mut held = control.clone();
    held.parameters.extend(constants.into_iter().cloned());
    let h0 = control.duration.first() / control.intervals as f64;
    match BoundaryConditions::resolve_held(system, &held, h0) {
        Err(BoundaryError::Parameter { name, reason }) => Err((name, reason)),
        // The solve itself tells of other mistakes.
        _ => Ok(()),
    }
}
