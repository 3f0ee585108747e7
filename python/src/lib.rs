//! The native part of the Python package: texts of problems in, folders of results and arrays of programs out.

use std::path::PathBuf;

use proboscis::app::{self, CommandError, CommandInput};
use proboscis::files::message;
use pyo3::prelude::*;
use serde::Serialize;

mod background;
mod controller;
mod program;
mod run;
mod variants;

use background::{Outcome, answer, supervised};

/// The one exception of the package: its message, the path of the wrong entry, the lines around it.
fn raised(py: Python<'_>, told: (String, String, String)) -> PyErr {
    let made = py
        .import("proboscis._error")
        .and_then(|module| module.getattr("Error"))
        .and_then(|class| class.call1(told));
    made.map_or_else(|failed| failed, PyErr::from_value)
}

/// Converts an error of a command to an exception.
fn error(py: Python<'_>, mistake: &CommandError) -> PyErr {
    let told = (
        message(&mistake.to_string()),
        mistake.place().to_owned(),
        mistake.excerpt().unwrap_or_default(),
    );
    raised(py, told)
}

/// Makes an exception for a wrong argument.
fn mistake(py: Python<'_>, message: String, argument: &str) -> PyErr {
    raised(py, (message, argument.to_owned(), String::new()))
}

/// A thread that ended without an answer.
fn broke_off(py: Python<'_>, why: &str) -> PyErr {
    mistake(py, format!("the run broke off: {why}"), "")
}

fn json(value: &impl Serialize) -> String {
    serde_json::to_string(value).expect("numbers and texts are JSON")
}

/// Checks the text of a problem; tells what it asks for.
#[pyfunction]
fn task(py: Python<'_>, input: PathBuf, text: String) -> PyResult<Outcome> {
    supervised(py, None, move |_| {
        app::check_text(&input, &text, &[]).map(|task| answer(task.to_owned()))
    })
}

/// The text of a problem with changes `path=value`.
#[pyfunction]
fn changed(
    py: Python<'_>,
    input: PathBuf,
    text: String,
    changes: Vec<String>,
) -> PyResult<Outcome> {
    supervised(py, None, move |_| {
        app::changed_text(&input, &text, &changes).map(answer)
    })
}

/// Returns the model of a problem, as JSON.
#[pyfunction]
fn inspect(py: Python<'_>, input: PathBuf, text: String) -> PyResult<Outcome> {
    let request = run::request(String::new(), input, None);
    supervised(py, None, move |_| {
        let found = app::inspected(&request, Some(&text))?;
        Ok(answer(json(&found)))
    })
}

/// Derivatives of a problem against differences, as JSON.
#[pyfunction]
fn check(
    py: Python<'_>,
    input: PathBuf,
    text: String,
    max_seconds: Option<f64>,
) -> PyResult<Outcome> {
    let request = CommandInput {
        max_seconds,
        ..run::request(String::new(), input, None)
    };
    supervised(py, None, move |_| {
        let found = app::checked(&request, Some(&text))?;
        Ok(answer(json(&found)))
    })
}

/// The JSON Schemas of scene and problem.
#[pyfunction]
fn schema() -> (String, String) {
    app::schema()
}

#[pymodule]
fn _proboscis(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add("version", env!("CARGO_PKG_VERSION"))?;
    module.add_class::<controller::Controller>()?;
    module.add_class::<program::Program>()?;
    module.add_class::<background::Ending>()?;
    module.add_function(wrap_pyfunction!(task, module)?)?;
    module.add_function(wrap_pyfunction!(changed, module)?)?;
    module.add_function(wrap_pyfunction!(inspect, module)?)?;
    module.add_function(wrap_pyfunction!(check, module)?)?;
    module.add_function(wrap_pyfunction!(schema, module)?)?;
    module.add_function(wrap_pyfunction!(run::run, module)?)?;
    module.add_function(wrap_pyfunction!(run::starts, module)?)?;
    module.add_function(wrap_pyfunction!(variants::sweep, module)?)?;
    module.add_function(wrap_pyfunction!(variants::study, module)?)
}
