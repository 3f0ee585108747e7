//! Voltages over time, and the files that hold them.

use crate::control::problem::Voltages;
use crate::files::json::error::SceneError;
use crate::files::json::scope::Scope;
use crate::files::problem::signal::signals;
use crate::files::problem::solution_voltages::{of_solution, of_table};
use crate::files::problem::spec_voltages::VoltagesSpec;
use crate::model::system::System;

/// Expected value of a path to an earlier result.
pub(crate) const SOLUTION_PATH: &str =
    "the path of a solution.json, or of the folder that holds it";

/// Voltages of a simulation.
pub(crate) fn over_time(
    spec: &VoltagesSpec,
    system: &System,
    scope: &Scope<'_>,
) -> Result<Voltages, SceneError> {
    match spec {
        VoltagesSpec::Signals(map) => signals(map, system, scope),
        VoltagesSpec::Solution(solution) => {
            let path = scope
                .key("solution")
                .solution_file(&solution.solution, SOLUTION_PATH)?;
            of_solution(&path, system)
        }
        VoltagesSpec::Table(table) => of_table(table, system, scope),
    }
}
