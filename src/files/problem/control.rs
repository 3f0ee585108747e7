//! Conversion of the control entry of a problem file to its task.

use crate::control::Earlier;
use crate::control::problem::{
    BoundaryState, Control, Duration, EnergyCost, Guess, Objective, Solver, SourceEnergy, Voltages,
    absent_loads,
};
use crate::files::json::scope::{Result, Scope, refuse, the_one};
use crate::files::problem::at::{At, ELECTRIC_KEYS};
use crate::files::problem::free::parameters;
use crate::files::problem::loads::{check_end, load, load_bounds, loads};
use crate::files::problem::quantities::keys::{at_the_end, limits, track};
use crate::files::problem::quantities::muscle::amount_costs;
use crate::files::problem::sensitivity::with_varied;
use crate::files::problem::spec_control::{
    ControlSpec, DurationSpec, EnergySpec, GuessSpec, IntervalsSpec, IntervalsWord, ObjectiveSpec,
    OptionSpec, SolverSpec,
};
use crate::files::problem::state::{Course, goal_state, sought_hold, start_state, waypoints};
use crate::files::problem::voltages::{SOLUTION_PATH, VoltagesSpec, over_time};
use crate::files::scene::constants::WrittenScene;
use crate::files::signal::signal;
use crate::files::solution::SolutionFile;
use crate::files::units::quantity::Voltage;
use crate::ipopt::{LinearSolver, OptionValue};
use crate::math::{Random, Signal, shortest};
use crate::model::Graph;
use crate::model::system::{Fidelity, Muscle, Source, System};
use std::collections::BTreeMap;

/// Most intervals of a control problem; a slip of the pen asks for more.
pub(crate) const MOST_INTERVALS: usize = 1_000_000;

/// Intervals of the first grid where no number is given.
const FIRST_INTERVALS: usize = 20;

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
    let intervals = match spec.intervals {
        Some(IntervalsSpec::Given(intervals)) => Some(intervals),
        Some(IntervalsSpec::Word(IntervalsWord::Auto)) | None => None,
    };
    at.optional("intervals", &intervals, |at, intervals| {
        at.count(*intervals, "interval", MOST_INTERVALS)
    })?;
    let takes_voltage = at.sources.iter().any(|source| source.takes_voltage);
    refuse!(if !takes_voltage && spec.load_bounds.is_empty(), at;
        found "a scene without any muscle or electrode that takes a voltage",
        expected format!("a muscle of {ELECTRIC_KEYS}, or a driven electrode"));
    let mut start = start_state(&spec.start, &at.key("start"))?;
    let mut objective = objective(&spec.objective, &at.key("objective"))?;
    let mut goal = goal(spec, &objective, at)?;
    let course = Course {
        duration,
        is_periodic: goal == BoundaryState::Periodic,
    };
    let (waypoints, near) = waypoints(&spec.waypoints, course, &at.key("waypoints"))?;
    objective.quantities.extend(near);
    let parameters = parameters(&spec.free, scene, &at.key("free"))?;
    let loads = loads(&spec.loads, &at.key("loads"))?;
    let load_bounds = load_bounds(&spec.load_bounds, &loads, &at.key("load_bounds"))?;
    check_end(&loads, &goal, duration, &at.key("loads"))?;
    load(&mut start, &loads, 0.0);
    load(&mut goal, &loads, duration.first());
    let (mut given, course) = given_voltages(spec, &at.key("voltages"))?;
    let is_sought = |s: usize| at.sources[s].takes_voltage && !given.contains_key(&s);
    let seeks_voltage = course.is_none() && (0..at.sources.len()).any(is_sought);
    let voltage_bounds = voltage_bounds(spec, seeks_voltage, at)?;
    for (key, state) in [("start", &start), ("goal", &goal)] {
        let is_given = |s: usize| course.is_some() || given.contains_key(&s);
        check_rest_voltages(state, is_given, voltage_bounds, &at.key(key))?;
    }
    given.extend(absent_loads(at.system, |source| {
        loads.contains_key(&source) || load_bounds.contains_key(&source)
    }));
    given.extend(loads);
    check_final_conditions(&goal, &at.key("goal"))?;
    let limits = limits(&spec.limits, &at.key("limits"))?;
    let guess = at.optional("guess", &spec.guess, |at, spec| {
        guess(spec, voltage_bounds, at)
    })?;
    let guess = guess.unwrap_or_else(|| unwritten(&goal, at.system));
    let control = Control {
        duration,
        intervals: intervals.unwrap_or(FIRST_INTERVALS),
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
        sought_hold: sought_hold(spec.goal.as_ref()),
        hold: spec.hold.into(),
        objective,
        limits,
        waypoints,
        coordinates: at.coordinates(spec.coordinates)?,
        guess,
        solver: solver(&spec.solver, &at.key("solver"))?,
    };
    let control = with_peak(control, &spec.objective, &at.key("objective"))?;
    with_varied(control, &spec.sensitivity, scene, &at.key("sensitivity"))
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

/// Bounds of voltages; needed where one is sought.
pub(crate) fn voltage_bounds(
    spec: &ControlSpec,
    is_needed: bool,
    at: &Scope<'_>,
) -> Result<[f64; 2]> {
    let Some([lower, upper]) = &spec.voltage_bounds else {
        refuse!(if is_needed, at;
            found "no key \"voltage_bounds\"", expected "the bounds of the voltages that are sought");
        return Ok([0.0; 2]);
    };
    let at = at.key("voltage_bounds");
    let bounds = [lower.value(), upper.value()];
    refuse!(if bounds[0] < 0.0, at.index(0);
        found lower, expected "a voltage that is not negative");
    refuse!(if bounds[0] > bounds[1], at.index(1);
        found upper,
        expected format!("an upper bound that is no less than the lower bound {lower}"));
    Ok(bounds)
}

/// Voltages that are given, source by source or all of them in intervals of time; one is left to be sought, unless a constant of
/// the scene is sought.
pub(crate) fn given_voltages(
    spec: &ControlSpec,
    at: &At<'_>,
) -> Result<(BTreeMap<usize, Signal>, Option<Voltages>)> {
    let mut given = BTreeMap::new();
    let mut course = None;
    match &spec.voltages {
        VoltagesSpec::Signals(map) => {
            for (name, spec) in map {
                let at = at.key(name);
                let source = at.driven(name)?;
                given.insert(source, signal(spec, &Voltage::kind(), &at)?);
            }
        }
        other => course = Some(over_time(other, at)?),
    }
    let jumps = matches!(course, Some(Voltages::Sampled { .. }));
    refuse!(if jumps && matches!(spec.duration, DurationSpec::Free(_)), at;
        found "voltages that jump from interval to interval where the duration is free",
        expected "functions of time by the names of sources, or a given duration");
    let is_sought =
        |s: usize| at.sources[s].takes_voltage && course.is_none() && !given.contains_key(&s);
    let seeks_load = !spec.load_bounds.is_empty();
    if (0..at.sources.len()).any(is_sought) || seeks_load || !spec.free.is_empty() {
        return Ok((given, course));
    }
    let expected = "at least one voltage that is not given, to be sought, or a constant of the scene under \"free\"";
    Err(at.wrong("all voltages", expected))
}

/// Rest voltages of sources that are sought lie in the bounds.
pub(crate) fn check_rest_voltages(
    state: &BoundaryState,
    is_given: impl Fn(usize) -> bool,
    [lower, upper]: [f64; 2],
    at: &At<'_>,
) -> Result<()> {
    let BoundaryState::RestAtVoltages(voltages, _) = state else {
        return Ok(());
    };
    for (s, (source, &voltage)) in at.sources.iter().zip(voltages).enumerate() {
        let outside = voltage < lower || voltage > upper;
        let is_sought = source.takes_voltage && !is_given(s);
        refuse!(if is_sought && outside, at.key("rest_at_voltages").key(&source.name);
            found format!("{} V", shortest(voltage, 9)),
            expected format!("a voltage within the bounds {lower} V to {upper} V"));
    }
    Ok(())
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

pub(crate) fn objective(spec: &ObjectiveSpec, at: &At<'_>) -> Result<Objective> {
    let weights = [
        ("effort", spec.effort),
        ("rate", spec.rate),
        ("duration", spec.duration),
        ("peak_voltage", spec.peak_voltage),
        ("muscle_volume", spec.muscle_volume),
        ("muscle_mass", spec.muscle_mass),
    ];
    for (key, weight) in weights {
        at.key(key).weight(weight)?;
    }
    let along: Vec<_> = at.key("track").each(&spec.track, track)?;
    let ends: Vec<_> = at.key("final").each(&spec.at_the_end, at_the_end)?;
    let mut quantities = [along, ends].concat().concat();
    quantities.extend(amount_costs([spec.muscle_volume, spec.muscle_mass], at)?);
    let [electrical, mechanical] = ["electrical_energy", "mechanical_work"].map(|key| at.key(key));
    let mut of_sources = energies(
        &spec.electrical_energy,
        SourceEnergy::Electrical,
        &electrical,
    )?;
    of_sources.extend(energies(
        &spec.mechanical_work,
        SourceEnergy::Mechanical,
        &mechanical,
    )?);
    let is_any = !quantities.is_empty() || !of_sources.is_empty();
    refuse!(if !is_any && weights.iter().all(|(_, weight)| *weight == 0.0), at;
        found "no weight",
        expected "a positive weight of \"effort\", \"rate\", \"duration\", \"peak_voltage\", \"muscle_volume\", \"muscle_mass\", \"electrical_energy\" or \"mechanical_work\", or something to \"track\" or a \"final\" place");
    Ok(Objective {
        effort: spec.effort,
        rate: spec.rate,
        duration: spec.duration,
        quantities,
        energies: of_sources,
    })
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

/// Names that an energy may have, for messages: the charge of an electrode of finite elements is not known at instants.
const LUMPED: &str =
    "lumped muscles: all sources, or those that \"sources\" names beside the \"weight\"";

/// The costs that one weight stands for; none where it is zero.
pub(crate) fn energies(
    spec: &EnergySpec,
    energy: SourceEnergy,
    at: &At<'_>,
) -> Result<Vec<EnergyCost>> {
    let cost = |source: usize, weight: f64, place: &At<'_>| {
        let cost = EnergyCost {
            source,
            energy,
            weight,
        };
        let muscle = at.system.muscles.get(source);
        let what = match muscle.and_then(|muscle| muscle.circuit) {
            Some(circuit) if circuit.resistance.is_none() => "leaks and has no resistor",
            Some(_) => "has a resistor",
            None => "drives finite elements",
        };
        let found = || format!("{:?}, which {what}", at.sources[source].name);
        refuse!(if !cost.exists(at.system), place; found found(), expected LUMPED);
        Ok(cost)
    };
    match spec {
        EnergySpec::All(weight) => {
            let weight = at.weight(*weight)?;
            let takes = |s: &usize| at.sources[*s].takes_voltage && weight > 0.0;
            let all = (0..at.sources.len()).filter(takes);
            all.map(|source| cost(source, weight, at)).collect()
        }
        EnergySpec::Named(spec) => {
            let weight = at.key("weight").weight(spec.weight)?;
            let list = at.key("sources");
            refuse!(if spec.sources.is_empty(), list;
                found "no source", expected "one source or more");
            let mut costs: Vec<EnergyCost> = Vec::new();
            for (index, name) in spec.sources.iter().enumerate() {
                let place = list.index(index);
                let source = place.driven(name)?;
                refuse!(if costs.iter().any(|cost| cost.source == source), place;
                    found format!("{name:?} again"), expected "each source once");
                costs.push(cost(source, weight, &place)?);
            }
            costs.retain(|cost| cost.weight > 0.0);
            Ok(costs)
        }
    }
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
            let voltages = drawn(of.seed, at.system, bounds);
            Ok(Guess::Simulate(Voltages::Constant(voltages)))
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
        } if has_elements => Guess::Simulate(Voltages::Constant(hold.clone())),
        _ => Guess::Interpolate,
    }
}

/// A voltage within the bounds for each source that takes one, drawn at random.
pub(crate) fn drawn(seed: u64, system: &System, [lower, upper]: [f64; 2]) -> Vec<f64> {
    let mut random = Random::new(seed);
    let draw = |source: &Source| match source.takes_voltage {
        true => random.between(lower, upper),
        false => 0.0,
    };
    system.sources().iter().map(draw).collect()
}
