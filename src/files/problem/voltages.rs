//! Voltages over time, and the files that hold them.

use crate::control::problem::Voltages;
use crate::files::json::error::SceneError;
use crate::files::json::scope::Scope;
use crate::files::problem::signal::signals;
use crate::files::problem::solution_voltages::{of_solution, of_table};
use crate::files::problem::spec_voltages::VoltagesSpec;
use crate::model::system::System;
use std::path::PathBuf;

/// Voltages of a simulation.
pub(crate) fn over_time(
    spec: &VoltagesSpec,
    system: &System,
    scope: &Scope<'_>,
) -> Result<Voltages, SceneError> {
    match spec {
        VoltagesSpec::Signals(map) => signals(map, system, scope),
        VoltagesSpec::Solution(solution) => {
            let path = existing(&solution.solution, &scope.key("solution"))?;
            of_solution(&path, system)
        }
        VoltagesSpec::Table(table) => of_table(table, system, scope),
    }
}

/// A file named in the problem: relative to the problem, otherwise to the current folder.
pub(crate) fn existing(path: &str, scope: &Scope<'_>) -> Result<PathBuf, SceneError> {
    let beside = scope.document.beside(path);
    [beside, PathBuf::from(path)]
        .into_iter()
        .find(|path| path.is_file())
        .ok_or_else(|| {
            let found = format!("{path:?}, where there is no file");
            scope.wrong(found, "the path of a solution.json")
        })
}
