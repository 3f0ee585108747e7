//! A solve that keeps its iterates in the folder of the results until it has ended.

use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

use crate::app::error::CommandError;
use crate::app::progress::{Progress, Reached};
use crate::app::request::CommandInput;
use crate::app::solution_file;
use crate::app::unfinished::Unfinished;
use crate::model::Model;
use crate::report::atomic::WriteError;
use crate::tasks::SolveRequest;
use crate::workflow::optimum::SolveLimits;
use crate::workflow::{Iterate, IterateMotions, WorkflowError};

/// Receives iterates with the number of their intervals, and says whether to go on.
pub(super) type Observe<'a> = &'a mut dyn FnMut(usize, &Iterate<'_>) -> ControlFlow<()>;

/// Solves what was `read` from files in some seconds; `keep` writes the motions of an iterate, the first of them at a path. Returns the result and the
/// folder that was made.
pub(super) fn solve<R>(
    request: &CommandInput,
    read: f64,
    observer: &mut dyn FnMut(Reached<'_>),
    keep: impl Fn(&Path, &[&Model], IterateMotions<'_>) -> Result<(), WriteError>,
    solve: impl FnOnce(SolveRequest, Observe<'_>) -> Result<R, WorkflowError>,
) -> Result<(R, PathBuf), CommandError> {
    let mut unfinished = Unfinished::new(request, solution_file::UNFINISHED);
    let limits = SolveLimits {
        iterations: request.max_iterations,
        seconds: request.max_seconds.map(|s| (s - read).max(0.0)),
    };
    let progress = Progress::of_solve(request.progress);
    let mut observe = |intervals: usize, iterate: &Iterate<'_>| {
        let Iterate { report, models, .. } = *iterate;
        progress.iteration(intervals, report);
        observer(Reached::Iteration(intervals, report));
        if report.iteration == 0 {
            unfinished.begin();
        }
        let (kept, motions) = iterate.before.unwrap_or((report, iterate.motions));
        unfinished.consider(kept.primal_infeasibility, |path| {
            keep(path, models, motions)
        });
        unfinished.flow()
    };
    let wanted = request.wanted;
    let found = solve(SolveRequest { wanted, limits }, &mut observe);
    let found = found.map_err(CommandError::in_file(&request.input))?;
    drop(progress);
    Ok((found, unfinished.made()?))
}
