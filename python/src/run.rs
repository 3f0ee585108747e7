//! A run of a problem, which writes a folder of results.

use std::path::PathBuf;

use proboscis::app::{CommandInput, RunIn, run_observed, solve_from_starts};
use proboscis::workflow::accuracy::AccuracyTarget;
use pyo3::prelude::*;

use crate::background::{Outcome, supervised};

/// A command on a problem with results in a folder, if in any.
pub(crate) fn request(command: String, input: PathBuf, folder: Option<PathBuf>) -> CommandInput {
    CommandInput {
        command,
        input,
        output: folder,
        ..CommandInput::default()
    }
}

/// Does what a problem asks and writes the folder.
#[pyfunction]
#[pyo3(signature = (input, text, folder, command, *, max_seconds, max_iterations, accuracy, estimate_error, observer))]
#[expect(clippy::too_many_arguments, reason = "keyword arguments of Python")]
pub(crate) fn run(
    py: Python<'_>,
    input: PathBuf,
    text: String,
    folder: PathBuf,
    command: String,
    max_seconds: Option<f64>,
    max_iterations: Option<usize>,
    accuracy: Option<f64>,
    estimate_error: bool,
    observer: Option<Bound<'_, PyAny>>,
) -> PyResult<Outcome> {
    let request = CommandInput {
        max_seconds,
        max_iterations,
        wanted: match (accuracy, estimate_error) {
            (Some(error), _) => Some(AccuracyTarget::Below(error)),
            (None, true) => Some(AccuracyTarget::Estimate),
            (None, false) => None,
        },
        ..request(command, input, Some(folder))
    };
    supervised(py, observer.as_ref(), move |hear| {
        run_observed(&request, Some(&text), hear)
    })
}

/// Solves a control problem from several starting points and writes the folder.
#[pyfunction]
#[pyo3(signature = (input, text, folder, command, count, seed, *, max_seconds, max_iterations))]
#[expect(clippy::too_many_arguments, reason = "keyword arguments of Python")]
pub(crate) fn starts(
    py: Python<'_>,
    input: PathBuf,
    text: String,
    folder: PathBuf,
    command: String,
    count: usize,
    seed: u64,
    max_seconds: Option<f64>,
    max_iterations: Option<usize>,
) -> PyResult<Outcome> {
    let request = CommandInput {
        max_seconds,
        max_iterations,
        ..request(command, input, Some(folder))
    };
    supervised(py, None, move |_| {
        solve_from_starts(&request, Some(&text), count, seed, RunIn::Here)
    })
}
