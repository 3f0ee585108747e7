//! Voltages over time, and the files that hold them.

use crate::control::problem::Voltages;
use crate::files::json::error::Result;
use crate::files::json::scope::Scope;
use crate::files::problem::solution_voltages::{of_solution, of_table};
use crate::files::problem::spec_voltages::VoltagesSpec;
use crate::files::problem::state::driven;
use crate::files::signal::signal;
use crate::files::signal::spec::SignalSpec;
use crate::files::units::quantity::Voltage;
use crate::math::Signal;
use crate::model::system::System;
use std::collections::BTreeMap;

/// Expected value of a path to an earlier result.
pub(crate) const SOLUTION_PATH: &str =
    "the path of a solution.json, or of the folder that holds it";

/// Voltages of a simulation.
pub(crate) fn over_time(
    spec: &VoltagesSpec,
    system: &System,
    scope: &Scope<'_>,
) -> Result<Voltages> {
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

/// Voltages by the names of sources; constant ones where all of them are.
pub(crate) fn signals(
    map: &BTreeMap<String, SignalSpec<Voltage>>,
    system: &System,
    scope: &Scope<'_>,
) -> Result<Voltages> {
    let sources = system.sources();
    let mut signals = vec![Signal::Constant(0.0); sources.len()];
    for (name, spec) in map {
        let scope = scope.key(name);
        signals[driven(name, &sources, &scope)?] = signal(spec, &Voltage::kind(), &scope)?;
    }
    Ok(Voltages::of_signals(signals))
}
