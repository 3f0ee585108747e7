//! As many processes at once as there are cores.

use super::ended::{Ended, best};
use super::launch::{Running, folder_of, launch};
use crate::app::error::CommandError;
use crate::app::progress::Progress;
use crate::app::request::CommandInput;
use crate::ipopt::interrupt;
use crate::report::atomic::WriteError;
use std::path::Path;
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

/// Runs the starts of a plan and tells how each ended, in the order of their numbers.
pub(super) fn run_all(
    request: &CommandInput,
    folder: &Path,
    plan: Vec<(usize, Option<u64>)>,
    began: Instant,
) -> Result<Vec<Ended>, CommandError> {
    let at_once = thread::available_parallelism().map_or(1, usize::from);
    let progress = Progress::of_starts(request.progress, plan.len());
    let mut waiting = plan.into_iter().peekable();
    let mut running = All(Vec::new());
    let mut ended: Vec<Ended> = Vec::new();
    let mut stop_at = None;
    loop {
        if interrupt::requested() && stop_at.is_none() {
            stop_at = Some(Instant::now() + GRACE);
        }
        let left = request
            .max_seconds
            .map(|limit| limit - began.elapsed().as_secs_f64());
        let may_start = stop_at.is_none() && left.is_none_or(|left| left > 0.0);
        while may_start && running.0.len() < at_once {
            let Some((start, seed)) = waiting.next() else {
                break;
            };
            let launched = launch(request, folder, start, seed, left);
            running.0.push(launched.map_err(|cause| WriteError {
                path: folder_of(folder, start),
                cause,
            })?);
        }
        if !may_start {
            for (start, seed) in waiting.by_ref() {
                ended.push(Ended::without_files(start, seed, "not_started", 0.0));
            }
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
                    let done = running.0.swap_remove(index);
                    ended.push(Ended::of(done, status, folder)?);
                    let solved = ended.iter().filter(|one| one.is_solved).count();
                    let best = best(&ended).and_then(|i| ended[i].objective);
                    progress.start(ended.len(), solved, best);
                }
                Err(cause) => {
                    let path = folder_of(folder, running.0[index].start);
                    return Err(WriteError { path, cause }.into());
                }
            }
        }
        if running.0.is_empty() && waiting.peek().is_none() {
            break;
        }
        thread::sleep(PATIENCE);
    }
    ended.sort_by_key(|one| one.start);
    Ok(ended)
}
