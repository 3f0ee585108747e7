//! Conversion of a problem file to its task, with one voltage per source and indices for names.

use crate::control::problem::{AtRest, Task};
use crate::files::json::scope::{Result, refuse, the_one};
use crate::files::problem::at::At;
use crate::files::problem::control::control;
use crate::files::problem::free::check_solution;
use crate::files::problem::identify::identification;
use crate::files::problem::loads::loads;
use crate::files::problem::simulation::simulation;
use crate::files::problem::spec::{EquilibriumSpec, ProblemSpec};
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
    at: &At<'_>,
) -> Result<Task> {
    the_one!(at, problem;
        "simulate" simulate |at, spec| {
            let task = simulation(spec, at)?;
            if let Some(path) = task.voltages.solution() {
                check_solution(path, scene, &at.key("voltages").key("solution"))?;
            }
            Ok(Task::Simulate(task))
        };
        "equilibrium" equilibrium |at, spec| equilibrium(spec, at);
        "control" control |at, spec| Ok(Task::Control(Box::new(control(spec, scene, at)?)));
        "identify" identify |at, spec| {
            Ok(Task::Identify(Box::new(identification(spec, scene, at)?)))
        };
    )
}

fn equilibrium(spec: &EquilibriumSpec, at: &At<'_>) -> Result<Task> {
    let mut voltages = at.key("voltages").voltages(&spec.voltages)?;
    let constant = |(name, size): (&String, &Quantity<LoadSize>)| {
        (name.clone(), SignalSpec::Constant(size.clone()))
    };
    let map = spec.loads.iter().map(constant).collect();
    for (source, load) in loads(&map, &at.key("loads"))? {
        voltages[source] = load.at(0.0);
    }
    let coordinates = at.coordinates(spec.coordinates)?;
    if let Some(points) = spec.path {
        at.key("path").count(points, "point", MOST_POINTS)?;
    }
    let response = Response::from(spec.response.unwrap_or_default());
    refuse!(if response == Response::Instantaneous && !at.system.has_branches(), at.key("response");
        found "\"instantaneous\"", expected NO_BRANCHES);
    Ok(Task::Equilibrium(AtRest {
        voltages,
        coordinates,
        response,
        path: spec.path,
    }))
}
