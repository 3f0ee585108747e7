//! A control problem as it is written, and its conversion to a task.

use crate::control::Earlier;
use crate::control::problem::{
    BoundaryState, Control, Duration, Guess, Objective, Solver, Voltages, absent_loads,
};
use crate::files::json::objects::read_objects;
use crate::files::json::scope::{Result, Scope, refuse, the_one};
use crate::files::problem::at::{At, CoordinatesSpec, ELECTRIC_KEYS};
use crate::files::problem::inputs::{
    LoadBounds, LoadMap, SOLUTION_PATH, VoltagesSpec, check_end, check_rest_voltages,
    given_voltages, load, load_bounds, loads, over_time, voltage_bounds,
};
use crate::files::problem::numbers::{FreeMap, SensitivityMap, parameters, varied};
use crate::files::problem::objective::{ObjectiveSpec, objective};
use crate::files::problem::quantities::keys::{LimitSpec, limits};
use crate::files::problem::state::{
    Course, GoalSpec, HoldSpec, StartSpec, WaypointSpec, goal_state, sought_hold, start_state,
    waypoints,
};
use crate::files::scene::constants::WrittenScene;
use crate::files::solution::SolutionFile;
use crate::files::study::ChangesSpec;
use crate::files::units::quantity::{Quantity, Time, Voltage};
use crate::ipopt::{LinearSolver, OptionValue};
use crate::math::Random;
use crate::model::Graph;
use crate::model::system::{Fidelity, Muscle, Source, System};
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::Deserialize;
use serde::de::IgnoredAny;
use serde_json::Value;
use std::borrow::Cow;
use std::collections::BTreeMap;

/// Most intervals of a control problem; a slip of the pen asks for more.
pub(crate) const MOST_INTERVALS: usize = 1_000_000;

/// Intervals of the first grid where no number is given.
const FIRST_INTERVALS: usize = 20;

/// Expected where all voltages are given.
const A_SOUGHT_INPUT: &str = "at least one voltage that is not given, to be sought, or a constant of the scene under \"free\"";

/// Expected in a problem of one motion for the keys of several.
const NO_MOTIONS: &str = "none without \"motions\"";

pub(crate) fn control(
    spec: &ControlSpec,
    scene: &WrittenScene<'_>,
    at: &At<'_>,
) -> Result<Control> {
    refuse!(if !spec.shared_inputs.is_empty(), at.key("shared_inputs");
        found "inputs in common", expected NO_MOTIONS);
    refuse!(if spec.combine.is_some(), at.key("combine");
        found "an objective of several motions", expected NO_MOTIONS);
    let duration = duration(&spec.duration, &at.key("duration"))?;
    let intervals = intervals(spec, at)?;
    let takes_voltage = at.sources.iter().any(|source| source.takes_voltage);
    refuse!(if !takes_voltage && spec.load_bounds.is_empty(), at;
        found "a scene without any muscle or electrode that takes a voltage",
        expected format!("a muscle of {ELECTRIC_KEYS}, or a driven electrode"));
    let mut start = start_state(&spec.start, &at.key("start"))?;
    let mut objective = objective(&spec.objective, &at.key("objective"))?;
    let mut goal = goal(spec, &objective, at)?;
    let course = Course {
        duration,
        is_open: matches!(goal, BoundaryState::Periodic | BoundaryState::Free),
    };
    let (waypoints, near) = waypoints(&spec.waypoints, course, &at.key("waypoints"))?;
    objective.quantities.extend(near);
    let parameters = parameters(&spec.free, scene, &at.key("free"))?;
    let loads = loads(&spec.loads, &at.key("loads"))?;
    let load_bounds = load_bounds(&spec.load_bounds, &loads, &at.key("load_bounds"))?;
    check_end(&loads, &goal, duration, &at.key("loads"))?;
    load(&mut start, &loads, 0.0);
    load(&mut goal, &loads, duration.first());
    let (mut given, course) = given_voltages(&spec.voltages, duration, &at.key("voltages"))?;
    let is_sought = |s: usize| at.sources[s].takes_voltage && !given.contains_key(&s);
    let seeks_voltage = course.is_none() && (0..at.sources.len()).any(is_sought);
    let seeks_any = seeks_voltage || !load_bounds.is_empty() || !parameters.is_empty();
    refuse!(if !seeks_any, at.key("voltages");
        found "all voltages", expected A_SOUGHT_INPUT);
    let voltage_bounds = voltage_bounds(&spec.voltage_bounds, seeks_voltage, at)?;
    for (key, state) in [("start", &start), ("goal", &goal)] {
        let is_given = |s: usize| course.is_some() || given.contains_key(&s);
        check_rest_voltages(state, is_given, voltage_bounds, &at.key(key))?;
    }
    given.extend(absent_loads(at.system, |source| {
        loads.contains_key(&source) || load_bounds.contains_key(&source)
    }));
    given.extend(loads);
    check_final_conditions(&goal, &at.key("goal"))?;
    let guess = at.optional("guess", &spec.guess, |at, spec| {
        guess(spec, voltage_bounds, at)
    })?;
    let guess = guess.unwrap_or_else(|| unwritten(&goal, at.system));
    let control = Control {
        duration,
        intervals: intervals.unwrap_or(FIRST_INTERVALS),
        input_intervals: 1,
        is_refined: intervals.is_none(),
        varied: Vec::new(),
        outcomes: Vec::new(),
        start,
        goal,
        voltage_bounds,
        load_bounds,
        given,
        course,
        parameters,
        continues: [false; 2],
        sought_hold: sought_hold(spec.goal.as_ref()),
        hold: spec.hold.into(),
        objective,
        limits: limits(&spec.limits, &at.key("limits"))?,
        waypoints,
        coordinates: spec.coordinates.map(Into::into),
        guess,
        solver: solver(&spec.solver, &at.key("solver"))?,
    };
    let control = with_peak(control, &spec.objective, &at.key("objective"))?;
    Ok(Control {
        varied: varied(&spec.sensitivity, &control, scene, &at.key("sensitivity"))?,
        ..control
    })
}

/// The number of intervals that is given.
fn intervals(spec: &ControlSpec, at: &At<'_>) -> Result<Option<usize>> {
    let Some(IntervalsSpec::Given(intervals)) = spec.intervals else {
        return Ok(None);
    };
    at.key("intervals")
        .count(intervals, "interval", MOST_INTERVALS)?;
    Ok(Some(intervals))
}

/// The goal; free where none is written and the objective names what to follow or where to end.
fn goal(spec: &ControlSpec, objective: &Objective, at: &At<'_>) -> Result<BoundaryState> {
    match &spec.goal {
        Some(goal) => goal_state(goal, &at.key("goal")),
        None if objective.quantities.is_empty()
            && spec.waypoints.iter().all(|point| point.weight.is_none()) =>
        {
            let expected = "the key \"goal\", or an objective that names something to \"track\" or a \"final\" place, or a waypoint with a weight";
            Err(at.wrong("no key \"goal\"", expected))
        }
        None => Ok(BoundaryState::Free),
    }
}

/// The problem with the cost of the peak voltage, where that has a weight.
fn with_peak(mut control: Control, spec: &ObjectiveSpec, at: &At<'_>) -> Result<Control> {
    let weight = spec.peak_voltage;
    let is_given = weight > 0.0 && !control.minimise_peak_voltage(weight, at.system);
    refuse!(if is_given, at.key("peak_voltage");
        found "a weight where all voltages are given", expected "a voltage that is sought");
    Ok(control)
}

pub(crate) fn duration(spec: &DurationSpec, at: &Scope<'_>) -> Result<Duration> {
    let free = match spec {
        DurationSpec::Given(duration) => return at.positive(duration).map(Duration::Given),
        DurationSpec::Free(free) => free,
    };
    let min = at.key("min").positive(&free.min)?;
    let max = at.key("max").positive(&free.max)?;
    let guess = at.key("guess").positive(&free.guess)?;
    refuse!(if min > max, at.key("max");
        found free.max, expected format!("a time that is no shorter than \"min\" {}", free.min));
    refuse!(if guess < min || guess > max, at.key("guess");
        found free.guess, expected format!("a time from {} to {}", free.min, free.max));
    Ok(Duration::Free { min, max, guess })
}

/// No more final conditions than degrees of freedom, where these can be counted from the joints: nodes bring more.
pub(crate) fn check_final_conditions(goal: &BoundaryState, at: &At<'_>) -> Result<()> {
    let lumped = |muscle: &Muscle| muscle.fidelity == Fidelity::Lumped;
    if !at.system.solids.is_empty() || !at.system.muscles.iter().all(lumped) {
        return Ok(());
    }
    let (conditions, key) = match goal {
        BoundaryState::Markers { places, .. } => {
            let given = places.values().map(|place| place.given().count());
            (given.sum(), "markers")
        }
        BoundaryState::JointAngles { angles, .. } => (angles.len(), "joint_angles"),
        BoundaryState::RestAtVoltages(..)
        | BoundaryState::EndOf(_)
        | BoundaryState::Free
        | BoundaryState::Periodic => {
            return Ok(());
        }
    };
    let graph = Graph::new(at.system);
    let freedoms = graph.coordinate_count(at.system);
    refuse!(if graph.loops().is_empty() && conditions > freedoms, at.key(key);
        found format!("{conditions} final conditions on positions"),
        expected format!("no more than the {freedoms} degrees of freedom"));
    Ok(())
}

pub(crate) fn solver(spec: &SolverSpec, at: &Scope<'_>) -> Result<Solver> {
    let default = Solver::default();
    let tolerance = spec.tolerance.unwrap_or(default.tolerance);
    refuse!(if tolerance <= 0.0, at.key("tolerance");
        found tolerance, expected "a positive tolerance");
    let max_iterations = spec.max_iterations.unwrap_or(default.max_iterations);
    refuse!(if i32::try_from(max_iterations).is_err(), at.key("max_iterations");
        found max_iterations, expected "a number of iterations below 2147483648");
    let option = |(name, value): (&String, &OptionSpec)| {
        let value = match value {
            OptionSpec::Integer(integer) => OptionValue::Integer(*integer),
            OptionSpec::Number(number) => OptionValue::Number(*number),
            OptionSpec::Text(text) => OptionValue::Text(text.clone()),
        };
        (name.clone(), value)
    };
    let linear_solver = linear_solver(spec, at)?;
    Ok(Solver {
        tolerance,
        max_iterations,
        linear_solver,
        ipopt: spec.ipopt.iter().map(option).collect(),
    })
}

/// Reads the solver of the linear systems; named once.
fn linear_solver(spec: &SolverSpec, at: &Scope<'_>) -> Result<LinearSolver> {
    let Some(named) = spec.linear_solver else {
        return Ok(LinearSolver::Auto);
    };
    let other = spec.ipopt.get("linear_solver");
    refuse!(if let Some(OptionSpec::Text(other)) = other, at.key("ipopt").key("linear_solver");
        found format!("{other:?}"),
        expected "one linear solver: \"linear_solver\" of \"solver\" names another one");
    Ok(named.into())
}

pub(crate) fn guess(spec: &GuessSpec, bounds: [f64; 2], at: &At<'_>) -> Result<Guess> {
    let GuessSpec::Object(spec) = spec else {
        return Ok(Guess::Interpolate);
    };
    the_one!(at, spec;
        "simulate" simulate |at, of| {
            over_time(&of.voltages, &at.key("voltages")).map(Guess::Simulate)
        };
        "solution" solution |at, path| {
            let path = at.solution_file(path, SOLUTION_PATH)?;
            Ok(Guess::Solution(Earlier::new(SolutionFile(path))))
        };
        "random" random |_, of| {
            let voltages = drawn(of.seed, at, bounds);
            Ok(Guess::Simulate(Voltages::constant(&voltages)))
        };
    )
}

/// The guess where none is written: of elastic blocks the motion under the voltages that hold the goal, where they are named, as the goal lacks the
/// places of nodes to interpolate between.
pub(crate) fn unwritten(goal: &BoundaryState, system: &System) -> Guess {
    let of_muscles = system
        .muscles
        .iter()
        .any(|m| m.fidelity != Fidelity::Lumped);
    let has_elements = of_muscles || !system.solids.is_empty();
    match goal {
        BoundaryState::Markers {
            hold: Some(hold), ..
        } if has_elements => Guess::Simulate(Voltages::constant(hold)),
        _ => Guess::Interpolate,
    }
}

/// A voltage within the bounds for each source that takes one, drawn at random.
fn drawn(seed: u64, at: &At<'_>, [lower, upper]: [f64; 2]) -> Vec<f64> {
    let mut random = Random::new(seed);
    let draw = |source: &Source| match source.takes_voltage {
        true => random.between(lower, upper),
        false => 0.0,
    };
    at.sources.iter().map(draw).collect()
}

read_objects! {
    /// An optimal control problem.
    #[schemars(transform = needed_without_motions)]
    pub struct ControlSpec {
        /// Final time, SI unit s, or its bounds and a guess.
        pub duration: DurationSpec,
        /// Number of intervals, 1 or more, or `"auto"`, as where it is not written: as many as the verification of the optimum needs to confirm
        /// an error of 1 % of the path length, or of the part that `--accuracy` gives.
        pub intervals: Option<IntervalsSpec>,
        /// Initial state; of a periodic motion, whose start is sought, the state where the solver begins.
        pub start: StartSpec,
        /// Final state; may be left out where the objective names something to `track` or where to end (`final`), and is free then.
        pub goal: Option<GoalSpec>,
        /// Lower and upper bound of every voltage that is sought, SI unit V; not needed where none is.
        pub voltage_bounds: Option<[Quantity<Voltage>; 2]>,
        /// Lower and upper bound of each load that is sought, by name, SI units N, N m, Pa, N/m³ and C/m².
        pub load_bounds?: LoadBounds,
        /// Loads that are given, by name, constant or functions of time, SI units N, N m, Pa, N/m³ and C/m²; 0 where neither given nor sought.
        pub loads?: LoadMap,
        /// Voltages that are given, by the names of muscles and driven electrodes (`block.electrode`), SI unit V: they are no unknowns,
        /// and one of 0 for all the time leaves no electric term at all. Functions of time, a table and those of a solution give all
        /// voltages, as of a simulation; then a constant of the scene has to be sought.
        pub voltages?: VoltagesSpec,
        /// Constants of the scene that are sought, by their paths, such as `materials.silicone.shear_modulus`.
        pub free?: FreeMap,
        /// Numbers by which the optimum is differentiated, by their paths: constants of the scene, such as `materials.silicone.shear_modulus`, and
        /// `duration`, `goal.joint_angles.NAME`, `goal.markers.NAME[0]`, `goal.rest_at_voltages.NAME`, `start.joint_angles.NAME`,
        /// `start.joint_rates.NAME`, `start.rest_at_voltages.NAME`, `voltage_bounds[1]`, `load_bounds.NAME[1]`, `objective.effort`, `objective.rate`,
        /// `objective.duration`.
        pub sensitivity?: SensitivityMap,
        /// Treatment of a goal that cannot be kept, because it is unstable or its voltages are beyond their bounds: it is
        /// `reported` (where not written), or refused where holding it is `required`.
        pub hold?: HoldSpec,
        /// Objective that is minimised.
        pub objective: ObjectiveSpec,
        /// Path limits.
        pub limits?: Vec<LimitSpec>,
        /// Places, orientations and joint coordinates that the motion reaches on its way.
        pub waypoints?: Vec<WaypointSpec>,
        /// Coordinates.
        pub coordinates: Option<CoordinatesSpec>,
        /// Initial guess of the solver; where not written, of elastic blocks whose goal has `hold`, the motion under these voltages, otherwise
        /// `"interpolate"`.
        pub guess: Option<GuessSpec>,
        /// Options of the solver.
        pub solver?: SolverSpec,
        /// Several motions in one optimisation: what `free` seeks is the same in all of them, and the objective is the sum of theirs. Each names the
        /// keys that are other ones in it.
        pub motions?: Vec<MotionSpec>,
        /// Phases of one motion, each of which goes on where the one before ended: the first one begins at `start`, the last one ends at `goal`. Each
        /// has its `duration`, given or with bounds and a guess, and the keys that are other ones in it; `duration` beside them is that of all together.
        pub phases?: Vec<MotionSpec>,
        /// Names of muscles, driven electrodes (`block.electrode`) and loads whose inputs are sought once for all motions; these have one
        /// given duration and one number of intervals.
        pub shared_inputs?: Vec<String>,
        /// The objective of several motions: the `sum` of theirs (where not written), or that of the `worst`, the greatest one.
        pub combine: Option<CombinedSpec>,
    }

    /// The objective of several motions.
    pub enum CombinedSpec {
        /// The sum of their objectives.
        Sum,
        /// The greatest of their objectives.
        Worst,
    }
}

/// Keys that are needed, but where each motion may have its own.
fn needed_without_motions(schema: &mut Schema) {
    if let Some(needed) = schema.remove("required") {
        let has = |key| json_schema!({ "required": [key] });
        let no_motions = json_schema!({ "not": { "anyOf": [has("motions"), has("phases")] } });
        schema.insert("if".into(), no_motions.to_value());
        let needed = json_schema!({ "required": needed });
        schema.insert("then".into(), needed.to_value());
    }
}

/// Keys of a control problem that all of its motions have in common.
pub(crate) const COMMON: [&str; 7] = [
    "combine",
    "free",
    "motions",
    "phases",
    "sensitivity",
    "shared_inputs",
    "solver",
];

/// One of several motions: the keys of a control problem that are other ones in it. It is read with those that it shares with the others.
#[derive(Clone, Debug, Deserialize)]
pub struct MotionSpec(IgnoredAny);

impl JsonSchema for MotionSpec {
    fn schema_name() -> Cow<'static, str> {
        "MotionSpec".into()
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        let name = json_schema!({
            "description": "Name, and that of its folder of results; one without a name has its number, as in `motion1`.",
            "type": ["string", "null"]
        });
        let mut set = generator.subschema_for::<ChangesSpec>();
        set.insert(
            "description".into(),
            "Constants of the scene that are other ones in this motion, by their places, such as `scene.materials.silicone.shear_modulus`.".into(),
        );
        let mut schema = ControlSpec::json_schema(generator);
        schema.remove("if");
        schema.remove("then");
        if let Some(Value::Object(keys)) = schema.get_mut("properties") {
            keys.retain(|key, _| !COMMON.contains(&&**key));
            keys.insert("name".into(), name.into());
            keys.insert("set".into(), set.into());
        }
        schema.insert(
            "description".into(),
            "One of several motions: the keys of a control problem that are other ones in it; those that it does not name are those of \
             `control`."
                .into(),
        );
        schema
    }
}

read_objects! {
    /// Number of intervals.
    #[derive(Copy)]
    pub auto IntervalsSpec("a whole number of intervals, or \"auto\"") {
        /// Intervals of no given number.
        IntervalsWord {
            /// As many as the verification needs.
            Auto
        },
        /// A number.
        Given: usize, true
    }

    /// Bounds of a free final time.
    pub struct FreeDurationSpec {
        /// Lower bound, SI unit s.
        pub min: Quantity<Time>,
        /// Upper bound, SI unit s.
        pub max: Quantity<Time>,
        /// Duration at which the solver starts, SI unit s.
        pub guess: Quantity<Time>,
    }

    /// Options of the solver.
    #[derive(Default)]
    pub struct SolverSpec {
        /// Relative tolerance, 1e-10 where not written.
        pub tolerance: Option<f64>,
        /// Limit of iterations, 500 where not written.
        pub max_iterations: Option<usize>,
        /// Solver of the linear systems, `auto` where not written.
        pub linear_solver: Option<ControlSolverSpec>,
        /// Options of Ipopt by name.
        pub ipopt: BTreeMap<String, OptionSpec>,
    }

    /// Solver of the linear systems of a control problem.
    pub enum ControlSolverSpec: LinearSolver {
        /// `stages` where Ipopt takes it, else `mumps`.
        Auto,
        /// LDLᵀ in the order of the horizon.
        Stages,
        /// LDLᵀ of MUMPS.
        Mumps,
    }
}

/// A value of an option of Ipopt.
#[derive(Clone, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(
    untagged,
    expecting = "another kind of value, expected a whole number, a number or a text"
)]
pub enum OptionSpec {
    /// Whole number.
    Integer(i32),
    /// Number.
    Number(f64),
    /// Text.
    Text(String),
}

read_objects! {
    /// A simulation as a guess.
    pub struct GuessSimulationSpec {
        /// Constant voltages, those of a solution, or a table, as of a simulation; 0 where not written.
        pub voltages?: VoltagesSpec,
    }

    /// A random guess.
    pub struct RandomGuessSpec {
        /// Equal seeds give equal guesses.
        pub seed: u64,
    }

    /// An object of a guess: exactly one of the three.
    pub struct GuessObjectSpec {
        /// A simulation under given voltages.
        pub simulate: Option<GuessSimulationSpec>,
        /// Path of a `solution.json` or of the folder that holds it, relative to this file or to the current folder.
        pub solution: Option<String>,
        /// A simulation under constant voltages drawn at random within the bounds.
        pub random: Option<RandomGuessSpec>,
    }

    /// A word of a guess.
    pub enum GuessWord {
        /// Smooth interpolation between start and goal.
        Interpolate,
    }

    /// A time, or bounds of a free one.
    pub either DurationSpec("a time, such as \"0.6 s\", or an object with \"min\", \"max\" and \"guess\"") {
        /// Given.
        Given: Quantity<Time>,
        /// Free.
        Free: FreeDurationSpec,
    }

    /// A word or an object.
    pub either GuessSpec("\"interpolate\" or an object with \"simulate\", \"solution\" or \"random\"") {
        /// `"interpolate"`.
        Word: GuessWord,
        /// An object.
        Object: GuessObjectSpec,
    }
}
