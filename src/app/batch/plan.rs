//! Solves of a batch, and the condition under which another one may begin.

use std::path::Path;
use std::time::Instant;

use super::end::RunIn;
use super::launch::as_typed;
use crate::app::request::CommandInput;
use crate::ipopt::interrupt;

/// Solves, each with a folder of its own.
#[derive(Debug)]
pub(crate) struct Batch<'a> {
    /// Solves.
    pub(crate) runs: &'a [CommandInput],
    /// Text that stands for that of the problem file, in threads.
    pub(crate) text: Option<&'a str>,
    /// Engine.
    pub(crate) run_in: RunIn,
    /// Folder of all results.
    pub(crate) folder: &'a Path,
    /// Seconds that all of them may take together.
    pub(crate) max_seconds: Option<f64>,
    /// Time at which the command began.
    pub(crate) began: Instant,
}

impl Batch<'_> {
    /// A solve in the time that is left; none after Ctrl-C or at the end of that time.
    pub(super) fn command(&self, run: &CommandInput) -> Option<CommandInput> {
        self.may_go_on().then(|| {
            as_typed(CommandInput {
                max_seconds: self.left(),
                ..run.clone()
            })
        })
    }

    /// Returns true if there is time left and Ctrl-C was not pressed.
    pub(super) fn may_go_on(&self) -> bool {
        !interrupt::requested() && self.left().is_none_or(|left| left > 0.0)
    }

    /// Seconds that are left.
    fn left(&self) -> Option<f64> {
        let spent = self.began.elapsed().as_secs_f64();
        self.max_seconds.map(|limit| limit - spent)
    }
}
