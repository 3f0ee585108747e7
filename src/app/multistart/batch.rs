//! The starts of a command, and when another one may begin.

use super::ended::{Ended, best};
use super::launch::{Start, command};
use crate::app::progress::Progress;
use crate::app::request::CommandInput;
use crate::ipopt::interrupt;
use serde::Serialize;
use std::path::Path;
use std::time::Instant;

/// The word of a start for which there was no time.
pub(super) const NOT_STARTED: &str = "not_started";

/// Where starts run.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum StartsIn {
    /// In threads of this process, where the linear solver allows that; in processes elsewhere.
    Threads,
    /// Each in a process of its own.
    Processes,
}

/// The starts of a command.
#[derive(Debug)]
pub(super) struct Batch<'a> {
    pub(super) request: &'a CommandInput,
    pub(super) run_in: StartsIn,
    pub(super) folder: &'a Path,
    pub(super) plan: &'a [Start],
    /// When the command began.
    pub(super) began: Instant,
}

impl Batch<'_> {
    /// The solve of a start, in the time that is left; none after Ctrl-C or at the end of that time.
    pub(super) fn command(&self, start: Start) -> Option<CommandInput> {
        let limit = self.request.max_seconds;
        let left = limit.map(|limit| limit - self.began.elapsed().as_secs_f64());
        let may_start = !interrupt::requested() && left.is_none_or(|left| left > 0.0);
        may_start.then(|| command(self.request, self.folder, start, left))
    }
}

/// Shows how many starts have ended, and the best of them.
pub(super) fn tell(progress: &Progress, ended: &[Ended]) {
    let solved = ended.iter().filter(|one| one.is_solved).count();
    let best = best(ended).and_then(|i| ended[i].objective);
    progress.start(ended.len(), solved, best);
}
