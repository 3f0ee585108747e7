//! Solves in threads of this process, as many in parallel as there are cores, or one.

use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

use super::end::{RunEnd, Said};
use super::launch::Batch;
use crate::app::error::CommandError;
use crate::app::request::CommandInput;
use crate::app::task;
use crate::workflow::parallel_map::parallel_map;

/// Runs all of a batch, at most this number in parallel.
pub(super) fn run_all(
    batch: &Batch<'_>,
    threads: usize,
    told: &mut dyn FnMut(usize, RunEnd) -> ControlFlow<()>,
) {
    let is_over = AtomicBool::new(false);
    let solve = |run: &CommandInput| {
        let command = batch.command(run);
        let Some(command) = command.filter(|_| !is_over.load(Ordering::Relaxed)) else {
            return RunEnd::NOT_STARTED;
        };
        let began = Instant::now();
        let said = match task::run_observed(&command, batch.text, &mut |_| {}) {
            Ok(output) if output.is_solved => Said::Solved,
            Ok(_) => Said::Unsolved(String::new()),
            Err(error) => said(&error),
        };
        RunEnd {
            said,
            seconds: began.elapsed().as_secs_f64(),
        }
    };
    parallel_map(batch.runs, threads, solve, |index, answered| {
        let end = answered.clone().unwrap_or_else(|panic| RunEnd {
            said: Said::Failed(panic),
            seconds: 0.0,
        });
        if told(index, end).is_break() {
            is_over.store(true, Ordering::Relaxed);
        }
    });
}

fn said(error: &CommandError) -> Said {
    let text = match error.excerpt() {
        Some(excerpt) => format!("{error}\n{}", excerpt.trim_end()),
        None => error.to_string(),
    };
    match error.exit_status() {
        2 => Said::Refused(text),
        _ => Said::Unsolved(text),
    }
}
