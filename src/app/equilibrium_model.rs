//! The model of an equilibrium.

use crate::app::error::CommandError;
use crate::app::request::CommandInput;
use crate::control::problem::AtRest;
use crate::model::{Model, System};
use crate::workflow::WorkflowError;

/// The model of an equilibrium.
///
/// # Errors
/// It does not exist in the coordinates asked for.
pub(super) fn model_at_rest(
    request: &CommandInput,
    system: &System,
    task: &AtRest,
) -> Result<Model, CommandError> {
    let model = Model::for_analysis(system.clone(), task.analysis(system));
    model.map_err(|error| {
        let error = WorkflowError::boundary("equilibrium", &error.into());
        CommandError::in_file(&request.input)(error)
    })
}
