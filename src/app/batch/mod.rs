//! Several solves in parallel, as many as there are cores: the starts of a problem, or the variants of a sweep.
//!
//! - `end`: the end of a solve; `launch`: a solve as typed, and a process of it; `threads`, `processes`, `hyperqueue`: engines.

mod end;
mod hyperqueue;
mod launch;
mod processes;
mod threads;

use std::ops::ControlFlow;

use crate::app::error::CommandError;
use crate::workflow::parallel_map::cores;
pub use end::RunIn;
pub(crate) use end::{RunEnd, Said, task_runs_at_once};
pub(crate) use launch::Batch;
pub use launch::end_with_parent;

/// Runs all of a batch; `told` is called at each end, in the thread that calls, and may let no other one begin.
///
/// # Errors
/// A process cannot be had.
pub(crate) fn run_all(
    batch: &Batch<'_>,
    told: &mut dyn FnMut(usize, RunEnd) -> ControlFlow<()>,
) -> Result<(), CommandError> {
    match batch.run_in {
        RunIn::Threads | RunIn::Here => {
            threads::run_all(batch, cores(), told);
            Ok(())
        }
        RunIn::InTurn => {
            threads::run_all(batch, 1, told);
            Ok(())
        }
        RunIn::Processes => processes::run_all(batch, told),
        RunIn::HyperQueue => hyperqueue::run_all(batch, told),
    }
}

/// Checks that solves can run there.
///
/// # Errors
/// A program that they need is missing.
pub(crate) fn check_run_in(run_in: RunIn) -> Result<(), CommandError> {
    match run_in {
        RunIn::Threads | RunIn::Here | RunIn::InTurn | RunIn::Processes => Ok(()),
        RunIn::HyperQueue => hyperqueue::check(),
    }
}
