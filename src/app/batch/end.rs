//! Engines that run solves, and the ends of solves.

use serde::Serialize;

use crate::control::problem::Task;
use crate::ipopt::Options;

/// Engine that runs the solves of a batch.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum RunIn {
    /// In threads of this process, where the linear solver allows that; in processes elsewhere.
    Threads,
    /// In this process: in threads, where the linear solver allows that, one after the other elsewhere.
    Here,
    /// One after the other, in this process.
    InTurn,
    /// Each in a process of its own.
    Processes,
    /// Each as a task of a HyperQueue server.
    #[serde(rename = "hyperqueue")]
    HyperQueue,
}

impl RunIn {
    /// The same for solves that may run in parallel with others in one process or not.
    pub(crate) fn of_tasks(self, run_at_once: bool) -> Self {
        match self {
            Self::Threads if !run_at_once => Self::Processes,
            Self::Here if run_at_once => Self::Threads,
            Self::Here => Self::InTurn,
            other => other,
        }
    }
}

/// Returns true if a task may run in parallel with others in one process.
pub(crate) fn task_runs_at_once(task: &Task) -> bool {
    let solver = match task {
        Task::Control(control) => &control.solver,
        Task::Motions(motions) => &motions.list[0].control.solver,
        Task::Simulate(_) | Task::Equilibrium(_) | Task::Identify(_) => return true,
    };
    let options = Options {
        linear_solver: solver.linear_solver,
        extra: solver.ipopt.clone(),
        ..Options::default()
    };
    options.run_at_once()
}

/// End of a solve.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Said {
    /// There was no time for it.
    NotStarted,
    /// The question has an answer.
    Solved,
    /// Its files give the reason; where it left none, these words do.
    Unsolved(String),
    /// It broke off.
    Failed(String),
    /// The input is wrong.
    Refused(String),
}

/// Returns the end of a process with a status and words on standard error; no status where a signal ended it.
pub(super) fn of_status(status: Option<i32>, words: &str) -> Said {
    let words = words.trim_end();
    let words = words.strip_prefix("error: ").unwrap_or(words).to_owned();
    match status {
        Some(0) => Said::Solved,
        Some(1) => Said::Unsolved(words),
        Some(2) => Said::Refused(words),
        _ => Said::Failed(words),
    }
}

/// The end of a solve.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct RunEnd {
    /// End, with the words of the solve.
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
