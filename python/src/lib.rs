//! The native part of the Python package: texts of problems in, folders of results and arrays of programs out.

use std::path::PathBuf;

use proboscis::app::{self, CommandError};
use proboscis::files::printable;
use pyo3::prelude::*;

mod program;
mod run;

/// A mistake as the one exception of the package: its message, the path of the wrong entry, the lines around it.
fn error(py: Python<'_>, mistake: &CommandError) -> PyErr {
    let told = (
        printable(&mistake.to_string()).into_owned(),
        mistake.place().to_owned(),
        mistake.excerpt().unwrap_or_default(),
    );
    let made = py
        .import("proboscis._error")
        .and_then(|module| module.getattr("Error"))
        .and_then(|class| class.call1(told));
    made.map_or_else(|failed| failed, PyErr::from_value)
}

/// Checks the text of a problem; returns what it asks for.
#[pyfunction]
fn check(
    py: Python<'_>,
    input: PathBuf,
    text: &str,
    changes: Vec<String>,
) -> PyResult<&'static str> {
    let checked = py.detach(|| app::check_text(&input, text, &changes));
    checked.map_err(|mistake| error(py, &mistake))
}

/// The JSON Schemas of scene and problem.
#[pyfunction]
fn schema() -> (String, String) {
    app::schema()
}

#[pymodule]
fn _proboscis(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add("version", env!("CARGO_PKG_VERSION"))?;
    module.add_class::<program::Program>()?;
    module.add_function(wrap_pyfunction!(check, module)?)?;
    module.add_function(wrap_pyfunction!(schema, module)?)?;
    module.add_function(wrap_pyfunction!(run::run, module)?)
}
