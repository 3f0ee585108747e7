//! Solves in processes, as many in parallel as there are cores.

use std::io::{Read, Seek};
use std::ops::ControlFlow;
use std::process::{Child, ExitStatus};
use std::thread;
use std::time::{Duration, Instant};

#[cfg(unix)]
use rustix::process::{Pid, Signal, kill_process};

use super::launch::{Batch, RunEnd, Running, Said, launch, of_status};
use crate::app::error::CommandError;
use crate::report::atomic::WriteError;
use crate::stop;
use crate::workflow::parallel_map::cores;

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

/// Runs all of a batch.
pub(super) fn run_all(
    batch: &Batch<'_>,
    told: &mut dyn FnMut(usize, RunEnd) -> ControlFlow<()>,
) -> Result<(), CommandError> {
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
                is_over |= told(index, RunEnd::NOT_STARTED).is_break();
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
                    let end = RunEnd {
                        said: said(&mut done, status),
                        seconds: done.began.elapsed().as_secs_f64(),
                    };
                    is_over |= told(done.index, end).is_break();
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

/// Returns the end of a process with a status.
fn said(done: &mut Running, status: ExitStatus) -> Said {
    let mut told = String::new();
    done.told.rewind().ok();
    done.told.read_to_string(&mut told).ok();
    of_status(status.code(), &told)
}
