//! Why nothing is found at rest.

use crate::dynamics::EquilibriumError;
use crate::run::error::RunError;
use crate::run::request::{CommandInput, CommandOutput};

/// Why there is no equilibrium at all: a floating block is wrong input, anything else a result without files.
pub(super) fn refused(
    request: &CommandInput,
    error: &EquilibriumError,
    result: &str,
) -> Result<CommandOutput, RunError> {
    match error {
        EquilibriumError::Floating { .. } => {
            return Err(RunError::Problem {
                file: request.input.clone(),
                place: "equilibrium".to_owned(),
                reason: error.to_string(),
            });
        }
        EquilibriumError::Stopped(status) => return Err(RunError::Stopped(*status)),
        _ => {}
    }
    Ok(CommandOutput {
        is_solved: false,
        result: result.to_owned(),
        notes: vec![error.to_string()],
    })
}
