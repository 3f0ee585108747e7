//! Starts in processes, as many at once as there are cores.

use super::batch::{Batch, NOT_STARTED, tell};
use super::ended::{Ended, Said};
use super::launch::{Running, folder_of, launch};
use crate::app::error::CommandError;
use crate::app::progress::Progress;
use crate::ipopt::interrupt;
use crate::report::atomic::WriteError;
use crate::workflow::at_once::cores;
use std::io::{Read, Seek};
use std::process::ExitStatus;
use std::thread;
use std::time::{Duration, Instant};

/// Time between two looks at the processes.
pub(super) const PATIENCE: Duration = Duration::from_millis(10);

/// Time that processes have to end in good order after Ctrl-C.
pub(super) const GRACE: Duration = Duration::from_secs(3);

/// The starts that run; none of them outlives this list.
pub(super) struct All(Vec<Running>);

impl Drop for All {
    fn drop(&mut self) {
        for running in &mut self.0 {
            running.child.kill().ok();
            running.child.wait().ok();
        }
    }
}

/// Runs the starts of a plan and tells how each ended.
pub(super) fn run_all(batch: &Batch<'_>) -> Result<Vec<Ended>, CommandError> {
    let progress = Progress::of_starts(batch.request.progress, batch.plan.len());
    let mut waiting = batch.plan.iter().copied().peekable();
    let mut running = All(Vec::new());
    let mut ended: Vec<Ended> = Vec::new();
    let mut stop_at = None;
    loop {
        if interrupt::requested() && stop_at.is_none() {
            stop_at = Some(Instant::now() + GRACE);
        }
        while running.0.len() < cores() {
            let Some(start) = waiting.next() else {
                break;
            };
            let Some(command) = batch.command(start) else {
                ended.push(Ended::without_files(start, NOT_STARTED, 0.0));
                continue;
            };
            let launched = launch(&command, start);
            running.0.push(launched.map_err(|cause| WriteError {
                path: command.folder(),
                cause,
            })?);
        }
        if stop_at.is_some_and(|time| Instant::now() > time) {
            for running in &mut running.0 {
                running.child.kill().ok();
            }
        }
        let mut index = 0;
        while index < running.0.len() {
            match running.0[index].child.try_wait() {
                Ok(None) => index += 1,
                Ok(Some(status)) => {
                    let mut done = running.0.swap_remove(index);
                    let said = said(&mut done, status);
                    let seconds = done.began.elapsed().as_secs_f64();
                    ended.push(Ended::of(done.start, said, seconds, batch.folder)?);
                    tell(&progress, &ended);
                }
                Err(cause) => {
                    let path = folder_of(batch.folder, running.0[index].start.number);
                    return Err(WriteError { path, cause }.into());
                }
            }
        }
        if running.0.is_empty() && waiting.peek().is_none() {
            break;
        }
        thread::sleep(PATIENCE);
    }
    Ok(ended)
}

/// What a process said when it ended with a status.
fn said(done: &mut Running, status: ExitStatus) -> Said {
    let mut told = String::new();
    done.told.rewind().ok();
    done.told.read_to_string(&mut told).ok();
    let told = told.trim_end();
    let told = told.strip_prefix("error: ").unwrap_or(told).to_owned();
    match status.code() {
        Some(0) => Said::Solved,
        Some(1) => Said::Unsolved(told),
        Some(2) => Said::Refused(told),
        _ => Said::Failed(told),
    }
}
