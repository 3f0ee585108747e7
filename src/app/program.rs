//! A problem in memory: whether it is one, and its nonlinear program for a solver of one's own.

use std::path::Path;

use crate::app::error::CommandError;
use crate::app::task::read;
use crate::app::words::key;
use crate::control::problem::Task;
use crate::nlp::Nlp;
use crate::workflow::optimise::{Counted, Prepared, prepare};
use crate::workflow::resolve::resolve;

/// Checks the text of a problem as if it stood in the file `input`, which need not exist: paths in it are relative to that file. Returns what it asks
/// for: `control`, `simulate` or `equilibrium`.
///
/// # Errors
/// The problem is wrong.
pub fn check_text(input: &Path, text: &str, set: &[String]) -> Result<&'static str, CommandError> {
    Ok(key(&read(input, Some(text), set)?.task))
}

/// Hands the nonlinear program of a control problem to `read`, with the point where the solver would start: in the units inside, g, mm, ms, N
/// and V.
///
/// # Errors
/// The problem is wrong, or asks for something else.
pub fn with_program<R>(
    input: &Path,
    text: &str,
    read_program: impl FnOnce(&mut dyn Nlp, &[f64]) -> R,
) -> Result<R, CommandError> {
    let loaded = read(input, Some(text), &[])?;
    let Task::Control(control) = &loaded.task else {
        return Err(CommandError::Problem {
            file: input.to_owned(),
            place: key(&loaded.task).to_owned(),
            reason: "only \"control\" is a nonlinear program".to_owned(),
        });
    };
    let (model, boundary) = resolve(&loaded.system, control).map_err(CommandError::of(input))?;
    let Prepared {
        mut program, point, ..
    } = prepare(&model, &boundary, control, None, Counted::Yes).map_err(CommandError::of(input))?;
    Ok(read_program(&mut program, &point.x))
}
