//! Variants of a problem: sweeps and studies.

use std::path::PathBuf;

use proboscis::app::{CommandInput, RunIn};
use proboscis::study::study as run_study;
use proboscis::sweep::{Shard, sweep as run_sweep};
use pyo3::prelude::*;

use crate::background::{Outcome, supervised};
use crate::mistake;
use crate::run::request;

/// Solves the variants of a sweep that are not solved yet, and writes the folder.
#[pyfunction]
#[pyo3(signature = (input, folder, command, shard, *, max_seconds))]
pub(crate) fn sweep(
    py: Python<'_>,
    input: PathBuf,
    folder: PathBuf,
    command: String,
    shard: &str,
    max_seconds: Option<f64>,
) -> PyResult<Outcome> {
    let shard: Shard = shard.parse().map_err(|expected: String| {
        mistake(py, format!("shard: found {shard:?}, {expected}"), "shard")
    })?;
    let request = CommandInput {
        max_seconds,
        ..request(command, input, Some(folder))
    };
    supervised(py, None, move |_| run_sweep(&request, shard, RunIn::Here))
}

/// Runs a study and writes the folder.
#[pyfunction]
pub(crate) fn study(
    py: Python<'_>,
    input: PathBuf,
    folder: PathBuf,
    command: String,
    runs: Option<usize>,
) -> PyResult<Outcome> {
    let request = request(command, input, Some(folder));
    supervised(py, None, move |_| run_study(&request, runs))
}
