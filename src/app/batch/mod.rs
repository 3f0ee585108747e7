//! Several solves in parallel, as many as there are cores: the starts of a problem, or the variants of a sweep.
//!
//! - `launch`: a solve as typed, a process of it, and its end; `processes`, `hyperqueue`: engines beside the threads of this process.

mod hyperqueue;
mod launch;
mod processes;

pub(crate) use launch::{Batch, Ended, task_runs_at_once};
pub use launch::{RunIn, end_with_parent};

use crate::app::error::CommandError;
use crate::app::kept::cache::run_once;
use crate::app::progress::{Progress, ProgressDisplay};
use crate::app::request::CommandInput;
use crate::app::task;
use crate::workflow::parallel_map::{cores, parallel_map};
use launch::{RunEnd, Said};
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

/// Runs all of a batch with a line of progress, in which each is called `what`. `told` is called at each end, in the thread that calls; it returns
/// the best objective so far. Where it fails, no other run begins.
///
/// # Errors
/// The first of `told`, or a process cannot be had.
pub(crate) fn run_all(
    batch: &Batch<'_>,
    what: &str,
    shown: ProgressDisplay,
    told: &mut dyn FnMut(usize, Ended) -> Result<Option<f64>, CommandError>,
) -> Result<(), CommandError> {
    let progress = Progress::of_runs(shown, what, batch.runs.len());
    let (mut ended, mut solved, mut failed) = (0, 0, None);
    let told = &mut |index: usize, end| {
        let one = Ended::new(end, &batch.runs[index].folder());
        ended += 1;
        solved += usize::from(one.is_solved);
        match told(index, one) {
            Ok(best) => {
                progress.run(ended, solved, best);
                ControlFlow::Continue(())
            }
            Err(error) => {
                failed.get_or_insert(error);
                ControlFlow::Break(())
            }
        }
    };
    match batch.run_in {
        RunIn::Threads | RunIn::Here => run_in_threads(batch, cores(), told),
        RunIn::InTurn => run_in_threads(batch, 1, told),
        RunIn::Processes => processes::run_all(batch, told),
        RunIn::HyperQueue => hyperqueue::run_all(batch, told),
    }?;
    failed.map_or(Ok(()), Err)
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

/// Runs all of a batch in threads of this process, at most this number in parallel.
fn run_in_threads(
    batch: &Batch<'_>,
    threads: usize,
    told: &mut dyn FnMut(usize, RunEnd) -> ControlFlow<()>,
) -> Result<(), CommandError> {
    let is_over = AtomicBool::new(false);
    let solve = |run: &CommandInput| {
        let command = batch.command(run);
        let Some(command) = command.filter(|_| !is_over.load(Ordering::Relaxed)) else {
            return RunEnd::NOT_STARTED;
        };
        let began = Instant::now();
        let answer = match run.once {
            true => run_once(&command),
            false => task::run_observed(&command, batch.text, &mut |_| {}),
        };
        let said = match answer {
            Ok(output) if output.is_solved => Said::Solved,
            Ok(_) => Said::Unsolved(String::new()),
            Err(error) => said(&error),
        };
        RunEnd {
            said,
            seconds: began.elapsed().as_secs_f64(),
        }
    };
    parallel_map(batch.runs, threads, solve, |index, answered| {
        let end = answered.clone().unwrap_or_else(|panic| RunEnd {
            said: Said::Failed(panic),
            seconds: 0.0,
        });
        if told(index, end).is_break() {
            is_over.store(true, Ordering::Relaxed);
        }
    });
    Ok(())
}

fn said(error: &CommandError) -> Said {
    let text = match error.excerpt() {
        Some(excerpt) => format!("{error}\n{}", excerpt.trim_end()),
        None => error.to_string(),
    };
    match error.exit_status() {
        2 => Said::Refused(text),
        _ => Said::Unsolved(text),
    }
}
