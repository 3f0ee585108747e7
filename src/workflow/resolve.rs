//! Model and boundary of a control problem, also with the parameters put in that were found.

use crate::control::problem::{Control, QuantityCost};
use crate::control::{BoundaryConditions, Solution};
use crate::model::{Model, System, What, with_parameters};
use crate::workflow::error::WorkflowError;
use crate::workflow::hold_check;

/// Model and boundary of a control problem.
pub(crate) fn resolve(
    system: &System,
    control: &Control,
) -> Result<(Model, BoundaryConditions), WorkflowError> {
    let (model, boundary) = BoundaryConditions::resolve(system, control, interval(control))
        .map_err(|error| WorkflowError::boundary("control", &error))?;
    hold_check::check(control, &model, &boundary)?;
    Ok((model, boundary))
}

/// Interval length in ms, or its guess.
pub(crate) fn interval(control: &Control) -> f64 {
    control.duration.first() / control.intervals as f64
}

/// Model and boundary of the system with the parameters put in that a motion was found with.
pub(crate) fn with_found(
    system: &System,
    control: &Control,
    sought: &Model,
    motion: &Solution,
) -> Result<(Model, BoundaryConditions), WorkflowError> {
    let values: Vec<f64> = motion.parameters.iter().map(|found| found.value).collect();
    let mut objective = control.objective.clone();
    // What nothing changes any more is no cost and no limit: a point that breaks one is an iterate, and the program says so.
    let amounts = |cost: &QuantityCost| matches!(cost.quantity.what, What::Amount { .. });
    objective.quantities.retain(|cost| !amounts(cost));
    let mut limits = control.limits.clone();
    limits.retain(|limit| !matches!(limit.what, What::Amount { .. }));
    let given = Control {
        parameters: Vec::new(),
        objective,
        limits,
        coordinates: Some(sought.coordinates),
        ..control.clone()
    };
    let system = with_parameters(system, &control.parameters, &values);
    let (model, boundary) = resolve(&system, &given)?;
    if model.action.map.unknowns() != sought.action.map.unknowns() {
        return Err(WorkflowError::Problem {
            place: "control.free".to_owned(),
            reason: "the identified values change which bodies can move; start from other guesses"
                .to_owned(),
        });
    }
    Ok((model, boundary))
}
