//! Conversion of a problem file to its task, with one voltage per source and indices for names.

use crate::control::problem::{AtRest, Task};
use crate::files::json::error::Result;
use crate::files::json::scope::Scope;
use crate::files::problem::control::control;
use crate::files::problem::coordinates::{coordinates, count};
use crate::files::problem::free::check_solution;
use crate::files::problem::identify::identification;
use crate::files::problem::loads::loads;
use crate::files::problem::simulation::simulation;
use crate::files::problem::spec::ProblemSpec;
use crate::files::problem::state::voltages;
use crate::files::scene::constants::WrittenScene;
use crate::files::signal::spec::SignalSpec;
use crate::files::units::quantity::{LoadSize, Quantity};
use crate::model::{NO_BRANCHES, Response};

/// Most equilibria of a path.
const MOST_POINTS: usize = 1_000_000;

/// The task that a problem asks of a system.
pub(crate) fn build_problem(
    problem: &ProblemSpec,
    scene: &WrittenScene<'_>,
    scope: &Scope<'_>,
) -> Result<Task> {
    let system = scene.system;
    type Build<'a> = Box<dyn FnOnce() -> Result<Task> + 'a>;
    let simulate = problem.simulate.as_ref().map(|spec| -> Build<'_> {
        Box::new(|| {
            let scope = scope.key("simulate");
            let task = simulation(spec, system, &scope)?;
            if let Some(path) = task.voltages.solution() {
                let place = scope.key("voltages").key("solution");
                check_solution(path, scene, &place)?;
            }
            Ok(Task::Simulate(task))
        })
    });
    let equilibrium = problem.equilibrium.as_ref().map(|spec| -> Build<'_> {
        Box::new(|| {
            let scope = scope.key("equilibrium");
            let mut voltages = voltages(&spec.voltages, system, &scope.key("voltages"))?;
            let constant = |(name, size): (&String, &Quantity<LoadSize>)| {
                (name.clone(), SignalSpec::Constant(size.clone()))
            };
            let map = spec.loads.iter().map(constant).collect();
            for (source, load) in loads(&map, system, &scope.key("loads"))? {
                voltages[source] = load.at(0.0);
            }
            let coordinates = coordinates(spec.coordinates, system, &scope)?;
            if let Some(points) = spec.path {
                count(points, "point", MOST_POINTS, &scope.key("path"))?;
            }
            let response = Response::from(spec.response.unwrap_or_default());
            if response == Response::Instantaneous && !system.has_branches() {
                let place = scope.key("response");
                return Err(place.wrong("\"instantaneous\"", NO_BRANCHES));
            }
            Ok(Task::Equilibrium(AtRest {
                voltages,
                coordinates,
                response,
                path: spec.path,
            }))
        })
    });
    let control = problem.control.as_ref().map(|spec| -> Build<'_> {
        Box::new(|| {
            let control = control(spec, scene, &scope.key("control"))?;
            Ok(Task::Control(Box::new(control)))
        })
    });
    let identify = problem.identify.as_ref().map(|spec| -> Build<'_> {
        Box::new(|| {
            let task = identification(spec, scene, &scope.key("identify"))?;
            Ok(Task::Identify(Box::new(task)))
        })
    });
    let build = scope.exactly_one([
        ("simulate", simulate),
        ("equilibrium", equilibrium),
        ("control", control),
        ("identify", identify),
    ])?;
    build()
}
