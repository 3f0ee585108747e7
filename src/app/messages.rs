//! Messages that several commands use.

use crate::control::problem::Task;

/// A number with its noun.
pub(super) fn counted(count: usize, noun: &str) -> String {
    format!("{count} {noun}{}", if count == 1 { "" } else { "s" })
}

/// Key of a task in its file.
pub(super) fn key(task: &Task) -> &'static str {
    match task {
        Task::Control(_) | Task::Motions(_) => "control",
        Task::Simulate(_) => "simulate",
        Task::Equilibrium(..) => "equilibrium",
        Task::Identify(_) => "identify",
    }
}
