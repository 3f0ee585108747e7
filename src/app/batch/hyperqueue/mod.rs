//! Solves as tasks of a HyperQueue server, which hands them to its workers.
//!
//! - `job`: what is kept of a job until all its ends are collected.
//!
//! The server keeps a job when the program that submitted it is gone. The next call finds the job by its name, collects what has
//! ended, waits for what runs, and submits only what is in no job. A task that the server begins once more, after a loss of its journal, finds
//! its own record and does nothing.

mod job;

use std::collections::BTreeMap;
use std::ops::ControlFlow;
use std::thread;
use std::time::{Duration, Instant};

use super::launch::{Batch, RunEnd};
use crate::app::error::CommandError;
use crate::app::request::CommandInput;
use job::Job;
pub(super) use job::check;

/// Least time between two questions to the server.
const PATIENCE: Duration = Duration::from_millis(200);

/// Part of the time that may pass with questions.
const SHARE: u32 = 10;

/// Runs all of a batch.
pub(super) fn run_all(
    batch: &Batch<'_>,
    told: &mut dyn FnMut(usize, RunEnd) -> ControlFlow<()>,
) -> Result<(), CommandError> {
    let mut open: BTreeMap<usize, &CommandInput> = batch.runs.iter().enumerate().collect();
    if let Some(job) = Job::earlier(batch.folder)? {
        follow(batch, &job, &mut open, told)?;
        job.forget();
    }
    let commands: Vec<CommandInput> = open.values().filter_map(|run| batch.command(run)).collect();
    if !commands.is_empty() && commands.len() == open.len() {
        let job = Job::submit(batch.folder, &commands)?;
        follow(batch, &job, &mut open, told)?;
        job.forget();
    }
    for index in open.into_keys() {
        // Nothing begins any more.
        let _ = told(index, RunEnd::NOT_STARTED);
    }
    Ok(())
}

/// Tells how the runs end that are tasks of a job, and strikes them off; those that were cancelled stay.
fn follow(
    batch: &Batch<'_>,
    job: &Job,
    open: &mut BTreeMap<usize, &CommandInput>,
    told: &mut dyn FnMut(usize, RunEnd) -> ControlFlow<()>,
) -> Result<(), CommandError> {
    let mut left = job.tasks_of(open);
    let mut is_cancelled = false;
    while !left.is_empty() {
        let asked = Instant::now();
        let mut is_over = !batch.may_go_on();
        for task in job.tasks()? {
            let Some(&index) = left.get(&task.id).filter(|_| task.has_ended()) else {
                continue;
            };
            left.remove(&task.id);
            let Some(end) = task.end(&job.standard_error(task.id)) else {
                continue;
            };
            open.remove(&index);
            is_over |= told(index, end).is_break();
        }
        if is_over && !is_cancelled {
            job.cancel()?;
            is_cancelled = true;
        }
        if !left.is_empty() {
            thread::sleep(PATIENCE.max(SHARE * asked.elapsed()));
        }
    }
    Ok(())
}
