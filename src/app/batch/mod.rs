//! Several solves at once, as many as there are cores: the starts of a problem, or the variants of a sweep.
//!
//! - `launch`: a solve as it is typed, and a process of it.
//! - `threads`, `processes`: where they run.

mod launch;
mod processes;
mod threads;

use std::ops::ControlFlow;
use std::time::Instant;

use serde::Serialize;

use crate::app::error::CommandError;
use crate::app::request::CommandInput;
use crate::ipopt::interrupt;
use launch::as_typed;

/// Where solves of a batch run.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum RunIn {
    /// In threads of this process, where the linear solver allows that; in processes elsewhere.
    Threads,
    /// Each in a process of its own.
    Processes,
}

/// What a solve says when it has ended.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Said {
    /// There was no time for it.
    NotStarted,
    /// The question has an answer.
    Solved,
    /// Its files tell why not; where it left none, these words do.
    Unsolved(String),
    /// It broke off.
    Failed(String),
    /// The input is wrong.
    Refused(String),
}

/// The end of a solve.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct RunEnd {
    /// What it said.
    pub(crate) said: Said,
    /// Wall time in s.
    pub(crate) seconds: f64,
}

impl RunEnd {
    /// There was no time for it.
    pub(crate) const NOT_STARTED: Self = Self {
        said: Said::NotStarted,
        seconds: 0.0,
    };
}

/// Solves, each with a folder of its own.
#[derive(Debug)]
pub(crate) struct Batch<'a> {
    /// What is solved.
    pub(crate) runs: &'a [CommandInput],
    /// Where.
    pub(crate) run_in: RunIn,
    /// Seconds that all of them may take together.
    pub(crate) max_seconds: Option<f64>,
    /// When the command began.
    pub(crate) began: Instant,
}

impl Batch<'_> {
    /// Runs all; `told` hears how each ended, in the thread that calls, and may let no other one begin.
    ///
    /// # Errors
    /// A process cannot be had.
    pub(crate) fn run(
        &self,
        told: &mut dyn FnMut(usize, RunEnd) -> ControlFlow<()>,
    ) -> Result<(), CommandError> {
        match self.run_in {
            RunIn::Threads => {
                threads::run_all(self, told);
                Ok(())
            }
            RunIn::Processes => processes::run_all(self, told),
        }
    }

    /// A solve in the time that is left; none after Ctrl-C or at the end of that time.
    fn command(&self, run: &CommandInput) -> Option<CommandInput> {
        let spent = self.began.elapsed().as_secs_f64();
        let left = self.max_seconds.map(|limit| limit - spent);
        let may_start = !interrupt::requested() && left.is_none_or(|left| left > 0.0);
        may_start.then(|| {
            as_typed(CommandInput {
                max_seconds: left,
                ..run.clone()
            })
        })
    }
}
