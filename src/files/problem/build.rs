//! The problem file, and its conversion to a task, with one voltage per source and indices for names.

use crate::control::problem::{AtRest, FrequencySweep, Task, VibrationRequest};
use crate::files::json::objects::read_objects;
use crate::files::json::scope::{Result, refuse, the_one};
use crate::files::problem::at::{At, CoordinatesSpec, VoltageMap};
use crate::files::problem::control::ControlSpec;
use crate::files::problem::control::control;
use crate::files::problem::feedback::FeedbackSpec;
use crate::files::problem::identify::{IdentifySpec, identification};
use crate::files::problem::inputs::loads;
use crate::files::problem::numbers::check_solution;
use crate::files::problem::output::OutputSpec;
use crate::files::problem::simulation::{SimulateSpec, simulation};
use crate::files::scene::constants::WrittenScene;
use crate::files::scene::spec::SceneSpec;
use crate::files::signal::SignalSpec;
use crate::files::units::quantity::{Frequency, LoadSize, Quantity};
use crate::model::{NO_BRANCHES, Response};
use std::collections::BTreeMap;

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
    let coordinates = spec.coordinates.map(Into::into);
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
        vibrations: vibrations(spec, at)?,
    }))
}

/// Most vibrations, and most frequencies of a response.
const MOST_VIBRATIONS: usize = 100;
const MOST_FREQUENCIES: usize = 10_000;

/// Vibrations about a state of rest.
fn vibrations(spec: &EquilibriumSpec, at: &At<'_>) -> Result<Option<VibrationRequest>> {
    let sweep = at.optional("frequency_response", &spec.frequency_response, sweep)?;
    if spec.modes.is_none() && sweep.is_none() {
        return Ok(None);
    }
    let place = at.key(if spec.modes.is_some() {
        "modes"
    } else {
        "frequency_response"
    });
    let other = match spec.path {
        Some(_) => Some("\"path\""),
        None if spec.response == Some(ResponseSpec::Instantaneous) => {
            Some("an \"instantaneous\" response")
        }
        None => None,
    };
    refuse!(if let Some(other) = other, place;
        found format!("it beside {other}"), expected "vibrations about one state of rest");
    if let Some(count) = spec.modes {
        place.count(count, "vibration", MOST_VIBRATIONS)?;
    }
    Ok(Some(VibrationRequest {
        count: spec.modes.unwrap_or(1),
        sweep,
    }))
}

/// An input that oscillates.
fn sweep(at: &At<'_>, spec: &FrequencyResponseSpec) -> Result<FrequencySweep> {
    let place = at.key("input");
    let source = place.source(&spec.input, "a muscle, a driven electrode or a load")?;
    let range = [&spec.from, &spec.to].map(Quantity::value);
    refuse!(if range[0] <= 0.0, at.key("from");
        found &spec.from, expected "a positive frequency");
    refuse!(if range[1] <= range[0], at.key("to");
        found &spec.to, expected format!("a frequency above \"from\", {}", spec.from));
    let points = spec.points.unwrap_or(200);
    at.key("points").count(points, "point", MOST_FREQUENCIES)?;
    refuse!(if points < 2, at.key("points"); found points, expected "two or more");
    Ok(FrequencySweep {
        source,
        range,
        points,
    })
}

read_objects! {
    /// Task for a scene: exactly one of `simulate`, `equilibrium`, `control`, `identify`.
    pub struct ProblemSpec {
        /// JSON Schema of this file, for editors.
        #[serde(rename = "$schema", default)]
        #[expect(dead_code, reason = "read by editors only")]
        pub(crate) schema: Option<String>,
        /// Path of the scene file, relative to this file, or the scene itself.
        pub scene: SceneSource,
        /// Forward simulation.
        pub simulate: Option<SimulateSpec>,
        /// Static equilibrium.
        pub equilibrium: Option<EquilibriumSpec>,
        /// Optimal control.
        pub control: Option<ControlSpec>,
        /// Constants fitted to recordings.
        pub identify: Option<IdentifySpec>,
        /// Gains of a controller that keeps the optimal motion.
        pub feedback: Option<FeedbackSpec>,
        /// Part of a motion that tables, figures and page show.
        pub output: Option<OutputSpec>,
    }

    /// A static equilibrium.
    pub struct EquilibriumSpec {
        /// Voltages by the names of muscles and driven electrodes (`block.electrode`), SI unit V; 0 where not named.
        pub voltages?: VoltageMap,
        /// Loads by name, SI units N, N m, Pa, N/m³ and C/m²; 0 where not named.
        pub loads: BTreeMap<String, Quantity<LoadSize>>,
        /// Coordinates.
        pub coordinates: Option<CoordinatesSpec>,
        /// Response of Maxwell branches; `relaxed` where not written.
        pub response: Option<ResponseSpec>,
        /// Number of points of the path of equilibria from zero voltage that are followed by arc length, past limit points such as pull-in.
        pub path: Option<usize>,
        /// Number of vibrations about the state, those of lowest frequencies: natural frequencies, damping ratios and shapes.
        pub modes: Option<usize>,
        /// Response of joints and markers to an input that oscillates about its value at rest.
        pub frequency_response: Option<FrequencyResponseSpec>,
    }

    /// An input that oscillates, and its frequencies, whose logarithms are evenly spaced.
    pub struct FrequencyResponseSpec {
        /// Name of the muscle, the driven electrode or the load.
        pub input: String,
        /// Lowest frequency, SI unit Hz.
        pub from: Quantity<Frequency>,
        /// Highest frequency, SI unit Hz.
        pub to: Quantity<Frequency>,
        /// Number of frequencies; 200 where not written.
        pub points: Option<usize>,
    }

    /// Response of Maxwell branches to voltages and loads.
    #[derive(Default)]
    pub enum ResponseSpec: Response {
        /// After a long time: branches carry nothing.
        #[default]
        Relaxed,
        /// At once: branches are springs without stress in the reference configuration.
        Instantaneous,
    }

    /// A scene by its path, or the scene itself.
    pub either SceneSource("the path of a scene file or a scene") {
        /// Path relative to the problem file.
        Path: String,
        /// The scene.
        Inline: Box<SceneSpec>,
    }
}
