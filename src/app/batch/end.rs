//! Where solves run, and how they end.

use serde::Serialize;

use crate::control::problem::Task;
use crate::ipopt::Options;

/// Where solves of a batch run.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum RunIn {
    /// In threads of this process, where the linear solver allows that; in processes elsewhere.
    Threads,
    /// Each in a process of its own.
    Processes,
}

/// Whether a task may be done beside others in one process.
pub(crate) fn task_runs_at_once(task: &Task) -> bool {
    match task {
        Task::Control(control) => Options {
            linear_solver: control.solver.linear_solver,
            extra: control.solver.ipopt.clone(),
            ..Options::default()
        }
        .run_at_once(),
        Task::Simulate(_) | Task::Equilibrium(_) => true,
    }
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
