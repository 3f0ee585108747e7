//! Starts in threads of this process, as many at once as there are cores.

use super::batch::{Batch, NOT_STARTED, tell};
use super::ended::{Ended, Said};
use super::launch::Start;
use crate::app::error::CommandError;
use crate::app::progress::Progress;
use crate::app::task;
use crate::workflow::at_once::{Answered, at_once, cores};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

/// Runs the starts of a plan and tells how each ended. Where one finds the input wrong no other one begins.
pub(super) fn run_all(batch: &Batch<'_>) -> Result<Vec<Ended>, CommandError> {
    let progress = Progress::of_starts(batch.request.progress, batch.plan.len());
    let is_refused = AtomicBool::new(false);
    let solve = |start: &Start| {
        let command = batch.command(*start);
        let command = command.filter(|_| !is_refused.load(Ordering::Relaxed))?;
        let began = Instant::now();
        let said = match task::run(&command) {
            Ok(told) if told.is_solved => Said::Solved,
            Ok(_) => Said::Unsolved(String::new()),
            Err(error) => said(&error),
        };
        if matches!(said, Said::Refused(_)) {
            is_refused.store(true, Ordering::Relaxed);
        }
        Some((said, began.elapsed().as_secs_f64()))
    };
    let mut ended = Vec::new();
    let mut refused = None;
    at_once(batch.plan, cores(), solve, |index, answered| {
        match of(batch, batch.plan[index], answered) {
            Ok(one) => ended.push(one),
            Err(error) => refused = refused.take().or(Some(error)),
        }
        tell(&progress, &ended);
    });
    refused.map_or(Ok(ended), Err)
}

fn said(error: &CommandError) -> Said {
    let told = match error.excerpt() {
        Some(excerpt) => format!("{error}\n{}", excerpt.trim_end()),
        None => error.to_string(),
    };
    match error.exit_status() {
        2 => Said::Refused(told),
        _ => Said::Unsolved(told),
    }
}

/// How a start ended: it was not begun, or said something, or there was a panic.
fn of(
    batch: &Batch<'_>,
    start: Start,
    answered: &Answered<Option<(Said, f64)>>,
) -> Result<Ended, CommandError> {
    let (said, seconds) = match answered {
        Ok(None) => return Ok(Ended::without_files(start, NOT_STARTED, 0.0)),
        Ok(Some((said, seconds))) => (said.clone(), *seconds),
        Err(panic) => (Said::Failed(panic.clone()), 0.0),
    };
    Ended::of(start, said, seconds, batch.folder)
}
