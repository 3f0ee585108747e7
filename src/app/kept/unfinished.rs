//! Latest iterate of a long run, stored in the folder of the results in case it is killed.

use crate::app::error::CommandError;
use crate::app::kept::record::{folder_within, make_folder, replaced};
use crate::app::kept::{resume_file, solution_file};
use crate::app::progress::{Progress, Reached};
use crate::app::request::CommandInput;
use crate::control::problem::ControlTask;
use crate::report::atomic::WriteError;
use crate::tasks::{MotionsResult, SolveRequest, solve_motions};
use crate::workflow::Iterate;
use crate::workflow::optimum::SolveLimits;
use std::fs;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// Shortest and longest time between two writings.
const PERIOD: [Duration; 2] = [Duration::from_secs(2), Duration::from_secs(30)];
/// Writing takes at most one part in this number of the time.
const SHARE: u32 = 20;
/// A point of no greater violation is as good as one that meets equations and limits.
const MEETS: f64 = 1e-6;

/// The folder of the results while a run goes on, with a file of it that is written anew now and then.
#[derive(Debug)]
pub(in crate::app) struct Unfinished {
    folder: PathBuf,
    path: PathBuf,
    /// Time from which on it may be written next.
    next: Instant,
    /// Violation of the point in the file.
    violation: f64,
    /// Reason why the folder cannot be made.
    unwritable: Option<WriteError>,
    /// A warning that the results of another problem are replaced, until it is told.
    replaced: Option<String>,
}

impl Unfinished {
    /// Nothing is written yet; the first time comes after two seconds.
    pub(in crate::app) fn new(request: &CommandInput, file: &str) -> Self {
        let folder = request.folder();
        Self {
            path: folder.join(file),
            folder,
            next: Instant::now() + PERIOD[0],
            violation: f64::INFINITY,
            unwritable: None,
            replaced: replaced(request),
        }
    }

    /// Makes the folder at the first iterate: one that cannot be made is told before a long run, not after it.
    pub(in crate::app) fn begin(&mut self) {
        if let Some(words) = self.replaced.take() {
            tracing::warn!("{words}");
        }
        if self.unwritable.is_none() {
            self.unwritable = make_folder(&self.folder).err();
        }
    }

    /// Ends a run whose folder cannot be made.
    pub(in crate::app) fn flow(&self) -> ControlFlow<()> {
        match self.unwritable {
            Some(_) => ControlFlow::Break(()),
            None => ControlFlow::Continue(()),
        }
    }

    /// The folder, once the run has ended.
    pub(in crate::app) fn made(mut self) -> Result<PathBuf, WriteError> {
        self.begin();
        match self.unwritable {
            Some(error) => Err(error),
            None => Ok(self.folder),
        }
    }

    /// Writes the iterate, when it is time and it is as good as the one written before: `violation` is that of its equations and
    /// limits.
    pub(in crate::app) fn consider(
        &mut self,
        violation: f64,
        write: impl FnOnce(&Path) -> Result<(), WriteError>,
    ) {
        let began = Instant::now();
        if began < self.next || violation > self.violation.max(MEETS) {
            return;
        }
        match write(&self.path) {
            Ok(()) => self.violation = violation,
            // The results of the whole run are written to the same folder, and tell it then.
            Err(error) => tracing::warn!("{error}"),
        }
        self.next = Instant::now() + (SHARE * began.elapsed()).clamp(PERIOD[0], PERIOD[1]);
    }
}

/// The results of a folder are complete: nothing is unfinished, of this run or an earlier one.
pub(in crate::app) fn done(folder: &Path) {
    solution_file::remove(&folder.join(solution_file::UNFINISHED));
    fs::remove_file(folder.join(resume_file::UNFINISHED)).ok();
}

/// Solves a task that was `read` from files in some seconds, and keeps its iterates. Returns the result and the folder that was made.
pub(in crate::app) fn solve(
    request: &CommandInput,
    task: &ControlTask<'_>,
    read: f64,
    observer: &mut dyn FnMut(Reached<'_>),
) -> Result<(MotionsResult, PathBuf), CommandError> {
    let mut unfinished = Unfinished::new(request, solution_file::UNFINISHED);
    let limits = SolveLimits {
        iterations: request.max_iterations,
        seconds: request.max_seconds.map(|s| (s - read).max(0.0)),
    };
    let results = request.folder();
    let progress = Progress::of_solve(request.progress);
    let mut observe = |intervals: usize, iterate: &Iterate<'_>| {
        let Iterate { report, models, .. } = *iterate;
        progress.iteration(intervals, report);
        observer(Reached::Iteration(intervals, report));
        if report.iteration == 0 {
            unfinished.begin();
        }
        let (kept, motions) = iterate.before.unwrap_or((report, iterate.motions));
        unfinished.consider(kept.primal_infeasibility, |_| {
            let mut each = task.motions.iter().zip(models).enumerate();
            each.try_for_each(|(number, (motion, model))| {
                let own = folder_within(&results, motion.name);
                make_folder(&own)?;
                solution_file::replace(
                    &own.join(solution_file::UNFINISHED),
                    model,
                    &motions(number),
                )
            })
        });
        unfinished.flow()
    };
    let wanted = request.wanted;
    let found = solve_motions(task, SolveRequest { wanted, limits }, &mut observe);
    let found = found.map_err(CommandError::in_file(&request.input))?;
    drop(progress);
    Ok((found, unfinished.made()?))
}
