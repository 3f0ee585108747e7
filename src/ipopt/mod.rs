//! Ipopt behind one safe type over the trait [`Nlp`].
//!
//! Solves with the linear solver along the horizon run in any number of threads, also within a callback. With MUMPS, which is not made for
//! more, one runs at a time in a process and a second call waits; an observer or an [`Nlp`] must not call [`solve`] itself then.

#[allow(
    dead_code,
    missing_docs,
    non_camel_case_types,
    non_snake_case,
    non_upper_case_globals,
    unreachable_pub,
    unsafe_code,
    reason = "made by `make bindings`; build.rs chooses those that agree with the header at hand"
)]
#[cfg_attr(ipopt_3_11, path = "bindings_3_11.rs")]
#[cfg_attr(ipopt_3_14, path = "bindings_3_14.rs")]
mod bindings;
mod evaluation;
mod ffi;
mod ma57_adapter;
mod options;
mod session;
mod solution;
mod solver;

use std::ops::ControlFlow;

use crate::nlp::Nlp;

pub use evaluation::{Before, Reached};
#[doc(hidden)]
pub use ma57_adapter::functions_of_ma57;
pub use options::LinearSolver;
pub use options::{MUMPS_ORDERING, Options, Start};
pub use solution::{
    Evaluations, Iteration, LinearReport, NoStages, OptionValue, Seconds, SolverResult,
    StagesReport, StartingPoint, VERSION,
};
pub use solver::IpoptError;
pub use solver::Solver;

/// Solves `nlp` from `start`, once: see [`Solver::solve`].
///
/// # Errors
///
/// As of [`Solver::solve`].
///
/// # Panics
///
/// As [`Solver::new`] and [`Solver::solve`] do.
pub fn solve(
    nlp: &mut dyn Nlp,
    start: &StartingPoint,
    options: &Options,
    observer: &mut dyn FnMut(&Iteration, &Reached<'_>) -> ControlFlow<()>,
) -> Result<SolverResult, IpoptError> {
    let mut solver = Solver::new(nlp, options.clone());
    solver.solve(start, observer)?;
    Ok(solver.into_result())
}
