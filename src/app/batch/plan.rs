//! What is to be solved, and when another solve may begin.

use std::time::Instant;

use super::end::RunIn;
use super::launch::as_typed;
use crate::app::request::CommandInput;
use crate::ipopt::interrupt;

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
    /// A solve in the time that is left; none after Ctrl-C or at the end of that time.
    pub(super) fn command(&self, run: &CommandInput) -> Option<CommandInput> {
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
