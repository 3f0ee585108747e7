//! States of rest under given voltages.

use crate::control::error::BoundaryError;
use crate::dynamics::{Equilibrium, stable_equilibrium};
use crate::model::{Analysis, Model, ModelError, Presolved, Role, with_parameters};

/// The equilibrium under voltages (V, one per muscle), with sought parameters at their guesses and prescribed coordinates at a time in ms.
///
/// # Errors
/// There is none.
pub fn rest_at(
    model: &Model,
    voltages: &[f64],
    (place, time): (&'static str, f64),
) -> Result<Equilibrium, BoundaryError> {
    let parameters = &model.analysis.parameters;
    if parameters.is_empty() {
        return equilibrium(model, voltages, (place, time));
    }
    let guesses: Vec<f64> = parameters.iter().map(|p| p.guess).collect();
    let mut found = rest_with(model, voltages, &guesses, (place, time))?;
    let at = model.variables.range(Role::Parameter).start;
    found.scalars.splice(at..at, guesses);
    Ok(found)
}

/// The equilibrium with given values of the parameters: loads grow from zero, and parameters are none.
pub(super) fn rest_with(
    model: &Model,
    voltages: &[f64],
    values: &[f64],
    at: (&'static str, f64),
) -> Result<Equilibrium, BoundaryError> {
    equilibrium(&with_values(model, values)?, voltages, at)
}

/// The model without sought parameters, with values put in their places.
pub(super) fn with_values(model: &Model, values: &[f64]) -> Result<Model, ModelError> {
    let sought = &model.analysis;
    let system = with_parameters(&model.system, &sought.parameters, values);
    // What may move is that of the model.
    let presolved = Presolved::new(&system, sought);
    let given = Analysis {
        parameters: Vec::new(),
        coordinates: Some(model.coordinates),
        ..sought.clone()
    };
    Model::of_presolved(system, given, presolved)
}

fn equilibrium(
    model: &Model,
    voltages: &[f64],
    (place, time): (&'static str, f64),
) -> Result<Equilibrium, BoundaryError> {
    let zero = model.reference_coordinates_at(time);
    let found = stable_equilibrium(model, &zero, &model.scalars(voltages));
    found.map_err(|source| BoundaryError::NoEquilibrium { place, source })
}
