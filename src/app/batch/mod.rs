//! Several solves in parallel, as many as there are cores: the starts of a problem, or the variants of a sweep.
//!
//! - `launch`: a solve as typed, a process of it, and its end; `hyperqueue`: an engine beside threads and processes of this machine.

use crate::app::error::CommandError;
use crate::app::kept::cache::run_once;
use crate::app::progress::{Progress, ProgressDisplay};
use crate::app::request::CommandInput;
use crate::app::task;
use crate::report::atomic::WriteError;
use crate::stop;
use crate::workflow::parallel_map::{cores, parallel_map};
pub(crate) use launch::{Batch, Ended, task_runs_at_once};
use launch::{EndObserver, RunEnd, Running, launch};
pub use launch::{RunIn, end_with_parent};
#[cfg(unix)]
use rustix::process::{Pid, Signal, kill_process};
use std::io::{Read, Seek};
use std::ops::ControlFlow;
use std::process::Child;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::{Duration, Instant};

mod hyperqueue;
mod launch;

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
        RunIn::Processes => run_in_processes(batch, told),
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
    told: EndObserver<'_>,
) -> Result<(), CommandError> {
    let is_over = AtomicBool::new(false);
    let solve = |run: &CommandInput| {
        let command = batch.command(run);
        let command = command.filter(|_| !is_over.load(Ordering::Relaxed))?;
        let began = Instant::now();
        let answer = match run.once {
            true => run_once(&command),
            false => task::run_observed(&command, batch.text, &mut |_| {}),
        };
        let (status, words) = match answer {
            Ok(output) => (u8::from(!output.is_solved), String::new()),
            Err(error) => (error.exit_status(), words(&error)),
        };
        Some(RunEnd {
            status: Some(status.into()),
            words,
            seconds: began.elapsed().as_secs_f64(),
        })
    };
    parallel_map(batch.runs, threads, solve, |index, answered| {
        let broken_off = |words| RunEnd {
            status: None,
            words,
            seconds: 0.0,
        };
        let end = answered.clone();
        let end = end.unwrap_or_else(|panic| Some(broken_off(panic)));
        if told(index, end).is_break() {
            is_over.store(true, Ordering::Relaxed);
        }
    });
    Ok(())
}

/// The words of the program on an error.
fn words(error: &CommandError) -> String {
    let excerpt = error.excerpt().unwrap_or_default();
    format!("{error}\n{excerpt}")
}

/// Time between two looks at the processes.
const PATIENCE: Duration = Duration::from_millis(10);

/// Time that processes have to write their results after Ctrl-C; who will not wait presses it again.
const GRACE: Duration = Duration::from_secs(20);

/// The solves that run; none of them outlives this list.
struct All(Vec<Running>);

impl Drop for All {
    fn drop(&mut self) {
        for running in &mut self.0 {
            running.child.kill().ok();
            running.child.wait().ok();
        }
    }
}

/// Runs all of a batch in processes.
fn run_in_processes(batch: &Batch<'_>, told: EndObserver<'_>) -> Result<(), CommandError> {
    let mut waiting = batch.runs.iter().enumerate().peekable();
    let mut running = All(Vec::new());
    let mut is_over = false;
    let mut stop_at = None;
    loop {
        if stop::requested() && stop_at.is_none() {
            stop_at = Some(Instant::now() + GRACE);
            running.0.iter().for_each(|one| ask_to_stop(&one.child));
        }
        while running.0.len() < cores() {
            let Some((index, run)) = waiting.next() else {
                break;
            };
            let Some(command) = batch.command(run).filter(|_| !is_over) else {
                is_over |= told(index, None).is_break();
                continue;
            };
            let launched = launch(&command, index);
            running
                .0
                .push(launched.map_err(WriteError::at(command.folder()))?);
        }
        if stop_at.is_some_and(|time| Instant::now() > time) {
            for running in &mut running.0 {
                running.child.kill().ok();
            }
        }
        let mut place = 0;
        while place < running.0.len() {
            match running.0[place].child.try_wait() {
                Ok(None) => place += 1,
                Ok(Some(status)) => {
                    let mut done = running.0.swap_remove(place);
                    let mut words = String::new();
                    done.told.rewind().ok();
                    done.told.read_to_string(&mut words).ok();
                    let end = RunEnd {
                        status: status.code(),
                        words,
                        seconds: done.began.elapsed().as_secs_f64(),
                    };
                    is_over |= told(done.index, Some(end)).is_break();
                }
                Err(cause) => {
                    let path = batch.runs[running.0[place].index].folder();
                    return Err(WriteError { path, cause }.into());
                }
            }
        }
        if running.0.is_empty() && waiting.peek().is_none() {
            return Ok(());
        }
        thread::sleep(PATIENCE);
    }
}

/// Asks a process to stop: a signal may have come to this one alone, and another one that came to both is not the same.
fn ask_to_stop(child: &Child) {
    #[cfg(unix)]
    if let Err(cause) = kill_process(Pid::from_child(child), Signal::TERM) {
        tracing::debug!("a process cannot be asked to stop: {cause}");
    }
    #[cfg(not(unix))]
    let _ = child;
}
