//! Conversion of the simulation entry of a problem file to its task.

use crate::control::problem::Simulation;
use crate::dynamics::{Integrator, Newton, Solving};
use crate::feedback::Law;
use crate::files::json::error::SceneError;
use crate::files::json::scope::Scope;
use crate::files::problem::coordinates::coordinates;
use crate::files::problem::driven::driven;
use crate::files::problem::feedback::controller;
use crate::files::problem::spec_integrator::integrator;
use crate::files::problem::spec_simulate::{LinearSolverSpec, SimulateSpec, StepSpec};
use crate::files::problem::spec_voltages::VoltagesSpec;
use crate::math::shortest;
use crate::model::system::System;

/// Tolerances below this ask for more than rounding allows.
pub(crate) const LEAST_TOLERANCE: f64 = 1e-9;

/// Most steps of a simulation.
pub(crate) const MOST_STEPS: f64 = 1e8;

pub(crate) fn simulation(
    spec: &SimulateSpec,
    system: &System,
    scope: &Scope<'_>,
) -> Result<Simulation, SceneError> {
    let duration = scope.key("duration").positive(&spec.duration)?;
    let method = integrator(spec.integrator.as_ref(), system, &scope.key("integrator"))?;
    let (step, tolerance) = step(spec, duration, method, scope)?;
    let (start, voltages) = driven(
        spec.start.as_ref(),
        (&spec.voltages, &spec.loads),
        system,
        scope,
    )?;
    let named = spec.linear_solver.unwrap_or(LinearSolverSpec::Auto);
    let (backend, multigrid) = named.taken();
    Ok(Simulation {
        duration,
        step,
        tolerance,
        start,
        voltages,
        coordinates: coordinates(spec.coordinates, system, scope)?,
        solving: Solving {
            integrator: method,
            newton: spec
                .newton
                .map_or_else(|| Newton::for_system(system), Into::into),
            backend,
            multigrid,
        },
        controller: match &spec.controller {
            Some(written) => {
                // The steps that are taken, which divide the duration.
                let equal = duration / (duration / step - 1e-9).ceil().max(1.0);
                let equal = tolerance.is_none().then_some(equal);
                let place = scope.key("controller");
                let controller = controller(written, equal, system, &place)?;
                if controller.delay > duration {
                    let found = format!("{} s", shortest(controller.delay / 1e3, 9));
                    let expected = format!("no more than the duration {}", spec.duration);
                    return Err(place.key("delay").wrong(found, expected));
                }
                refuse_given(spec, &controller.law, scope)?;
                Some(Box::new(controller))
            }
            None => None,
        },
    })
}

/// Refuses voltages and loads that are written for inputs which the controller gives.
pub(crate) fn refuse_given(
    spec: &SimulateSpec,
    law: &Law,
    scope: &Scope<'_>,
) -> Result<(), SceneError> {
    let of_voltages: Vec<&String> = match &spec.voltages {
        VoltagesSpec::Signals(map) => map.keys().collect(),
        VoltagesSpec::Table(table) => table.voltages.keys().collect(),
        VoltagesSpec::Solution(_) => Vec::new(),
    };
    let loads = spec.loads.keys().map(|name| ("loads", name));
    let mut written = of_voltages
        .into_iter()
        .map(|name| ("voltages", name))
        .chain(loads);
    match written.find(|(_, name)| law.inputs.iter().any(|input| input.name == **name)) {
        None => Ok(()),
        Some((key, name)) => {
            let found = format!("{name:?}, an input that the controller gives");
            let expected = "other inputs alone beside \"controller\"";
            Err(scope.key(key).key(name).wrong(found, expected))
        }
    }
}

/// Length of the steps in ms, of the first attempt where a tolerance controls it, and the tolerance.
pub(crate) fn step(
    spec: &SimulateSpec,
    duration: f64,
    method: Integrator,
    scope: &Scope<'_>,
) -> Result<(f64, Option<f64>), SceneError> {
    let Some(StepSpec::Given(written)) = &spec.step else {
        if method != Integrator::Midpoint {
            let found = format!(
                "steps of no given length with the integrator {}",
                method.name()
            );
            let expected = "a step, such as \"10 ms\": only the midpoint rule chooses its steps";
            return Err(scope.wrong(found, expected));
        }
        let tolerance = spec.tolerance.unwrap_or(Simulation::TOLERANCE);
        if !(LEAST_TOLERANCE..1.0).contains(&tolerance) {
            let expected = format!("a tolerance from {LEAST_TOLERANCE:.0e} to below 1");
            return Err(scope
                .key("tolerance")
                .wrong(tolerance.to_string(), expected));
        }
        return Ok((Simulation::FIRST * duration, Some(tolerance)));
    };
    let place = scope.key("step");
    let step = place.positive(written)?;
    if let Some(tolerance) = spec.tolerance {
        let found = format!("{tolerance} beside steps of {written}");
        let expected = "a tolerance only where the step is \"auto\" or not written";
        return Err(scope.key("tolerance").wrong(found, expected));
    }
    if step > duration {
        let expected = format!(
            "a step that is no longer than the duration {}",
            spec.duration
        );
        return Err(place.wrong(written.to_string(), expected));
    }
    if duration / step > MOST_STEPS {
        let found = format!("{written}, which makes {:.0e} steps", duration / step);
        return Err(place.wrong(found, format!("no more than {MOST_STEPS:.0e} steps")));
    }
    Ok((step, None))
}
