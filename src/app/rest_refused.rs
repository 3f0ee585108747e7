//! Error or result of a search for an equilibrium that finds none.

use crate::app::error::CommandError;
use crate::app::no_equilibrium;
use crate::app::request::{CommandInput, CommandOutput};
use crate::dynamics::EquilibriumError;

/// Handles a missing equilibrium: a floating block is wrong input, anything else a result of which the summary alone is written.
pub(super) fn refused(
    request: &CommandInput,
    error: &EquilibriumError,
    result: &str,
) -> Result<CommandOutput, CommandError> {
    match error {
        EquilibriumError::Floating { .. } => {
            return Err(CommandError::Problem {
                file: request.input.clone(),
                place: "equilibrium".to_owned(),
                reason: error.to_string(),
            });
        }
        EquilibriumError::Stopped(status) => return Err(CommandError::Stopped(*status)),
        _ => {}
    }
    no_equilibrium::write(request, &error.to_string())?;
    Ok(CommandOutput {
        is_solved: false,
        result: format!("{result}, {}", request.folder().display()),
        notes: vec![error.to_string()],
    })
}
