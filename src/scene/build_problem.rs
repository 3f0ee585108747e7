//! From a problem as written to the task it means, with one voltage per source and indices for names.

use std::collections::BTreeMap;
use std::path::PathBuf;

use crate::control::problem::{
    AtRest, Control, Duration, Guess, Objective, Simulation, Solver, State, Task, Voltages,
};
use crate::dynamics::{Integrator, Newton, Solving};
use crate::ipopt::OptionValue;
use crate::math::random::Random;
use crate::model::Coordinates;
use crate::model::system::{Fidelity, Muscle, Source, System};
use crate::scene::build_limits::limit;
use crate::scene::build_state::{ELECTRIC_KEYS, driven, goal_state, start_state, voltages};
use crate::scene::error::SceneError;
use crate::scene::graph::tree_freedoms;
use crate::scene::scope::Scope;
use crate::scene::solution::{of_solution, of_table};
use crate::scene::spec_integrator::integrator;
use crate::scene::spec_problem::{
    ControlSpec, CoordinatesSpec, DurationSpec, GuessSpec, ObjectiveSpec, OptionSpec, ProblemSpec,
    SimulateSpec, SolverSpec, StepSpec, VoltagesSpec,
};

/// Most intervals of a control problem; a slip of the pen asks for more.
const MOST_INTERVALS: usize = 1_000_000;
/// Tolerance of steps of no given length, where none is written.
const TOLERANCE: f64 = 1e-3;
/// Tolerances below this ask for more than rounding allows.
const LEAST_TOLERANCE: f64 = 1e-9;
/// The first step that a tolerance controls, as a part of the duration.
const FIRST: f64 = 1e-2;
/// Most steps of a simulation.
const MOST_STEPS: f64 = 1e8;
/// Most equilibria of a path.
const MOST_POINTS: usize = 1_000_000;

/// The task that a problem asks of a system.
pub(crate) fn build_problem(
    problem: &ProblemSpec,
    system: &System,
    scope: &Scope<'_>,
) -> Result<Task, SceneError> {
    type Build<'a> = Box<dyn FnOnce() -> Result<Task, SceneError> + 'a>;
    let simulate = problem.simulate.as_ref().map(|spec| -> Build<'_> {
        Box::new(|| simulation(spec, system, &scope.key("simulate")).map(Task::Simulate))
    });
    let equilibrium = problem.equilibrium.as_ref().map(|spec| -> Build<'_> {
        Box::new(|| {
            let scope = scope.key("equilibrium");
            let voltages = voltages(&spec.voltages, system, &scope.key("voltages"))?;
            let coordinates = coordinates(spec.coordinates, system, &scope)?;
            if let Some(points) = spec.path {
                count(points, "point", MOST_POINTS, &scope.key("path"))?;
            }
            Ok(Task::Equilibrium(AtRest {
                voltages,
                coordinates,
                path: spec.path,
            }))
        })
    });
    let control = problem.control.as_ref().map(|spec| -> Build<'_> {
        Box::new(|| {
            let control = control(spec, system, &scope.key("control"))?;
            Ok(Task::Control(Box::new(control)))
        })
    });
    let build = scope.exactly_one([
        ("simulate", simulate),
        ("equilibrium", equilibrium),
        ("control", control),
    ])?;
    build()
}

fn simulation(
    spec: &SimulateSpec,
    system: &System,
    scope: &Scope<'_>,
) -> Result<Simulation, SceneError> {
    let duration = scope.key("duration").positive(&spec.duration)?;
    let method = integrator(spec.integrator.as_ref(), system, &scope.key("integrator"))?;
    let (step, tolerance) = step(spec, duration, method, scope)?;
    let start = match &spec.start {
        Some(start) => start_state(start, system, &scope.key("start"))?,
        None => State::JointAngles {
            angles: BTreeMap::new(),
            rates: BTreeMap::new(),
            velocities: Default::default(),
        },
    };
    let place = scope.key("voltages");
    let voltages = over_time(&spec.voltages, system, &place)?;
    Ok(Simulation {
        duration,
        step,
        tolerance,
        start,
        voltages,
        coordinates: coordinates(spec.coordinates, system, scope)?,
        solving: Solving {
            integrator: method,
            newton: spec.newton.map_or_else(|| newton(system), Into::into),
            backend: spec.linear_solver.map(Into::into),
        },
    })
}

/// Voltages of a simulation.
fn over_time(
    spec: &VoltagesSpec,
    system: &System,
    scope: &Scope<'_>,
) -> Result<Voltages, SceneError> {
    match spec {
        VoltagesSpec::Constant(map) => voltages(map, system, scope).map(Voltages::Constant),
        VoltagesSpec::Solution(solution) => {
            let path = existing(&solution.solution, &scope.key("solution"))?;
            of_solution(&path, system)
        }
        VoltagesSpec::Table(table) => of_table(table, system, scope),
    }
}

/// Length of the steps in ms, of the first attempt where a tolerance controls it, and the tolerance.
fn step(
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
        let tolerance = spec.tolerance.unwrap_or(TOLERANCE);
        if !(LEAST_TOLERANCE..1.0).contains(&tolerance) {
            let expected = format!("a tolerance from {LEAST_TOLERANCE:.0e} to below 1");
            return Err(scope
                .key("tolerance")
                .wrong(tolerance.to_string(), expected));
        }
        return Ok((FIRST * duration, Some(tolerance)));
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

/// When the tangent of a step is factorised, where nothing is written: the factorisation of finite elements is worth keeping,
/// that of a few joint coordinates is not (benches/README.md).
fn newton(system: &System) -> Newton {
    let mut muscles = system.muscles.iter();
    let of_muscles = muscles.any(|muscle| muscle.fidelity != Fidelity::Lumped);
    match of_muscles || !system.solids.is_empty() {
        true => Newton::Reused,
        false => Newton::Full,
    }
}

fn control(spec: &ControlSpec, system: &System, scope: &Scope<'_>) -> Result<Control, SceneError> {
    let duration = duration(&spec.duration, &scope.key("duration"))?;
    let place = scope.key("intervals");
    count(spec.intervals, "interval", MOST_INTERVALS, &place)?;
    if !system.sources().iter().any(|source| source.takes_voltage) {
        let found = "a scene without any muscle or electrode that takes a voltage";
        let expected = format!("a muscle of {ELECTRIC_KEYS}, or a driven electrode");
        return Err(scope.wrong(found, expected));
    }
    let voltage_bounds = voltage_bounds(spec, &scope.key("voltage_bounds"))?;
    let start = start_state(&spec.start, system, &scope.key("start"))?;
    let goal = goal_state(&spec.goal, system, &scope.key("goal"))?;
    let given = given_voltages(spec, system, &scope.key("voltages"))?;
    for (key, state) in [("start", &start), ("goal", &goal)] {
        check_rest_voltages(state, system, &given, voltage_bounds, &scope.key(key))?;
    }
    check_final_conditions(&goal, system, &scope.key("goal"))?;
    let mut limits = Vec::new();
    for (index, spec) in spec.limits.iter().enumerate() {
        limits.extend(limit(spec, system, &scope.key("limits").index(index))?);
    }
    Ok(Control {
        duration,
        intervals: spec.intervals,
        start,
        goal,
        voltage_bounds,
        given,
        hold: spec.hold.into(),
        objective: objective(&spec.objective, &scope.key("objective"))?,
        limits,
        coordinates: coordinates(spec.coordinates, system, scope)?,
        guess: guess(&spec.guess, system, voltage_bounds, &scope.key("guess"))?,
        solver: solver(&spec.solver, &scope.key("solver"))?,
    })
}

/// A number of things from one to a limit.
fn count(value: usize, noun: &str, most: usize, scope: &Scope<'_>) -> Result<(), SceneError> {
    let expected = match value {
        0 => format!("1 {noun} or more"),
        _ if value > most => format!("no more than {most} {noun}s"),
        _ => return Ok(()),
    };
    Err(scope.wrong(value.to_string(), expected))
}

fn duration(spec: &DurationSpec, scope: &Scope<'_>) -> Result<Duration, SceneError> {
    let free = match spec {
        DurationSpec::Given(duration) => return scope.positive(duration).map(Duration::Given),
        DurationSpec::Free(free) => free,
    };
    let min = scope.key("min").positive(&free.min)?;
    let max = scope.key("max").positive(&free.max)?;
    let guess = scope.key("guess").positive(&free.guess)?;
    if min > max {
        let expected = format!("a time that is no shorter than \"min\" {}", free.min);
        return Err(scope.key("max").wrong(free.max.to_string(), expected));
    }
    if guess < min || guess > max {
        let expected = format!("a time from {} to {}", free.min, free.max);
        return Err(scope.key("guess").wrong(free.guess.to_string(), expected));
    }
    Ok(Duration::Free { min, max, guess })
}

fn voltage_bounds(spec: &ControlSpec, scope: &Scope<'_>) -> Result<[f64; 2], SceneError> {
    let [lower, upper] = &spec.voltage_bounds;
    let bounds = [lower.value(), upper.value()];
    if bounds[0] < 0.0 {
        return Err(scope
            .index(0)
            .wrong(lower.to_string(), "a voltage that is not negative"));
    }
    if bounds[0] > bounds[1] {
        let expected = format!("an upper bound that is no less than the lower bound {lower}");
        return Err(scope.index(1).wrong(upper.to_string(), expected));
    }
    Ok(bounds)
}

/// Voltages that are given for all the time; one is left to be looked for.
fn given_voltages(
    spec: &ControlSpec,
    system: &System,
    scope: &Scope<'_>,
) -> Result<BTreeMap<usize, f64>, SceneError> {
    let sources = system.sources();
    let mut given = BTreeMap::new();
    for (name, voltage) in &spec.voltages {
        given.insert(driven(name, &sources, &scope.key(name))?, voltage.value());
    }
    let is_sought = |s: usize| sources[s].takes_voltage && !given.contains_key(&s);
    if (0..sources.len()).any(is_sought) {
        return Ok(given);
    }
    let found = "all voltages";
    Err(scope.wrong(
        found,
        "one voltage or more that is not given, to be looked for",
    ))
}

/// Rest voltages of sources that are looked for lie in the bounds.
fn check_rest_voltages(
    state: &State,
    system: &System,
    given: &BTreeMap<usize, f64>,
    [lower, upper]: [f64; 2],
    scope: &Scope<'_>,
) -> Result<(), SceneError> {
    let State::RestAtVoltages(voltages) = state else {
        return Ok(());
    };
    for (s, (source, &voltage)) in system.sources().iter().zip(voltages).enumerate() {
        let outside = voltage < lower || voltage > upper;
        if outside && source.takes_voltage && !given.contains_key(&s) {
            let place = scope.key("rest_at_voltages").key(&source.name);
            let found = format!("{voltage} V");
            let expected = format!("a voltage within the bounds {lower} V to {upper} V");
            return Err(place.wrong(found, expected));
        }
    }
    Ok(())
}

/// No more final conditions than degrees of freedom, where these can be counted from the joints: nodes bring more.
fn check_final_conditions(
    goal: &State,
    system: &System,
    scope: &Scope<'_>,
) -> Result<(), SceneError> {
    let lumped = |muscle: &Muscle| muscle.fidelity == Fidelity::Lumped;
    if !system.solids.is_empty() || !system.muscles.iter().all(lumped) {
        return Ok(());
    }
    let (conditions, key) = match goal {
        State::Markers { places, .. } => (3 * places.len(), "markers"),
        State::JointAngles { angles, .. } => (angles.len(), "joint_angles"),
        State::RestAtVoltages(_) => return Ok(()),
    };
    match tree_freedoms(system.bodies.len(), &system.joints) {
        Some(freedoms) if conditions > freedoms => {
            let found = format!("{conditions} final conditions on positions");
            let expected = format!("no more than the {freedoms} degrees of freedom");
            Err(scope.key(key).wrong(found, expected))
        }
        _ => Ok(()),
    }
}

fn coordinates(
    spec: Option<CoordinatesSpec>,
    system: &System,
    scope: &Scope<'_>,
) -> Result<Option<Coordinates>, SceneError> {
    let bodies = system.bodies.len();
    let place = scope.key("coordinates");
    match spec {
        None => Ok(None),
        Some(CoordinatesSpec::Redundant) => Ok(Some(Coordinates::Redundant)),
        Some(CoordinatesSpec::Reduced) if tree_freedoms(bodies, &system.joints).is_none() => {
            let found = "\"reduced\", though the joints close a loop";
            Err(place.wrong(found, "\"redundant\""))
        }
        Some(CoordinatesSpec::Reduced) => Ok(Some(Coordinates::Reduced)),
    }
}

fn objective(spec: &ObjectiveSpec, scope: &Scope<'_>) -> Result<Objective, SceneError> {
    let weights = [
        ("effort", spec.effort),
        ("rate", spec.rate),
        ("duration", spec.duration),
    ];
    for (key, weight) in weights {
        if weight < 0.0 {
            let expected = "a weight that is not negative";
            return Err(scope.key(key).wrong(weight.to_string(), expected));
        }
    }
    if weights.iter().all(|(_, weight)| *weight == 0.0) {
        let expected = "a positive weight of \"effort\", \"rate\" or \"duration\"";
        return Err(scope.wrong("no weight", expected));
    }
    Ok(Objective {
        effort: spec.effort,
        rate: spec.rate,
        duration: spec.duration,
    })
}

fn guess(
    spec: &GuessSpec,
    system: &System,
    bounds: [f64; 2],
    scope: &Scope<'_>,
) -> Result<Guess, SceneError> {
    let GuessSpec::Object(spec) = spec else {
        return Ok(Guess::Interpolate);
    };
    type Build<'a> = Box<dyn FnOnce() -> Result<Guess, SceneError> + 'a>;
    let simulate = spec.simulate.as_ref().map(|simulate| -> Build<'_> {
        let scope = scope.key("simulate").key("voltages");
        Box::new(move || over_time(&simulate.voltages, system, &scope).map(Guess::Simulate))
    });
    let solution = spec.solution.as_ref().map(|solution| -> Build<'_> {
        let scope = scope.key("solution");
        Box::new(move || existing(solution, &scope).map(Guess::Solution))
    });
    let random = spec.random.as_ref().map(|random| -> Build<'_> {
        Box::new(|| {
            let voltages = drawn(random.seed, system, bounds);
            Ok(Guess::Simulate(Voltages::Constant(voltages)))
        })
    });
    let build = scope.exactly_one([
        ("simulate", simulate),
        ("solution", solution),
        ("random", random),
    ])?;
    build()
}

/// A voltage within the bounds for each source that takes one, drawn at random.
fn drawn(seed: u64, system: &System, [lower, upper]: [f64; 2]) -> Vec<f64> {
    let mut random = Random::new(seed);
    let draw = |source: &Source| match source.takes_voltage {
        true => random.between(lower, upper),
        false => 0.0,
    };
    system.sources().iter().map(draw).collect()
}

fn solver(spec: &SolverSpec, scope: &Scope<'_>) -> Result<Solver, SceneError> {
    let tolerance = spec.tolerance.unwrap_or(1e-10);
    if tolerance <= 0.0 {
        let expected = "a positive tolerance";
        return Err(scope
            .key("tolerance")
            .wrong(tolerance.to_string(), expected));
    }
    let max_iterations = spec.max_iterations.unwrap_or(500);
    if i32::try_from(max_iterations).is_err() {
        let expected = "a number of iterations below 2147483648";
        let place = scope.key("max_iterations");
        return Err(place.wrong(max_iterations.to_string(), expected));
    }
    let option = |(name, value): (&String, &OptionSpec)| {
        let value = match value {
            OptionSpec::Integer(integer) => OptionValue::Integer(*integer),
            OptionSpec::Number(number) => OptionValue::Number(*number),
            OptionSpec::Text(text) => OptionValue::Text(text.clone()),
        };
        (name.clone(), value)
    };
    Ok(Solver {
        tolerance,
        max_iterations,
        ipopt: spec.ipopt.iter().map(option).collect(),
    })
}

/// A file named in the problem: relative to the problem, otherwise to the current folder.
fn existing(path: &str, scope: &Scope<'_>) -> Result<PathBuf, SceneError> {
    let beside = scope.document.beside(path);
    [beside, PathBuf::from(path)]
        .into_iter()
        .find(|path| path.is_file())
        .ok_or_else(|| {
            let found = format!("{path:?}, where there is no file");
            scope.wrong(found, "the path of a solution.json")
        })
}
