//! The command `check`: the derivatives of the problem of a file against differences.

use std::time::Instant;

use crate::app::error::CommandError;
use crate::app::request::{CommandInput, CommandOutput};
use crate::app::task::read;
use crate::tasks::{self, CheckResult};

/// Compares gradient, Jacobian and Hessian with differences; not solved where an entry is wrong.
///
/// # Errors
/// The input is wrong.
pub fn check(request: &CommandInput) -> Result<CommandOutput, CommandError> {
    let found = checked(request, None)?;
    Ok(CommandOutput {
        is_solved: found.agrees,
        result: found.message,
        notes: found.notes,
    })
}

/// Returns the same as numbers. The problem may be given as `text`; the path is then used for messages and relative paths.
///
/// # Errors
/// As of [`check`].
pub fn checked(request: &CommandInput, text: Option<&str>) -> Result<CheckResult, CommandError> {
    let began = Instant::now();
    let loaded = read(&request.input, text, &request.set)?;
    let left = |seconds| seconds - began.elapsed().as_secs_f64();
    tasks::check(&loaded.system, loaded.task, request.max_seconds.map(left))
        .map_err(CommandError::in_file(&request.input))
}
