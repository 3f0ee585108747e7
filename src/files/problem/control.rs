//! Conversion of the control entry of a problem file to its task.

use crate::control::Earlier;
use crate::control::problem::{
    BoundaryState, Control, Duration, EnergyCost, Guess, Objective, Solver, SourceEnergy, Voltages,
    absent_loads,
};
use crate::files::json::error::Result;
use crate::files::json::scope::Scope;
use crate::files::problem::coordinates::{coordinates, count};
use crate::files::problem::free::parameters;
use crate::files::problem::goal::goal_state;
use crate::files::problem::loads::{check_end, load, load_bounds, loads};
use crate::files::problem::motions::check_alone;
use crate::files::problem::quantities::keys::{at_the_end, limits, track};
use crate::files::problem::quantities::muscle::amount_costs;
use crate::files::problem::sensitivity::with_varied;
use crate::files::problem::spec_control::{
    ControlSolverSpec, ControlSpec, DurationSpec, GuessSpec, IntervalsSpec, IntervalsWord,
    ObjectiveSpec, OptionSpec, SolverSpec,
};
use crate::files::problem::spec_energies::EnergySpec;
use crate::files::problem::spec_voltages::VoltagesSpec;
use crate::files::problem::state::{ELECTRIC_KEYS, driven, sought_hold, start_state};
use crate::files::problem::voltages::{SOLUTION_PATH, over_time};
use crate::files::problem::waypoints::waypoints;
use crate::files::scene::constants::WrittenScene;
use crate::files::scene::graph::tree_freedoms;
use crate::files::signal::signal;
use crate::files::solution::SolutionFile;
use crate::files::units::quantity::Voltage;
use crate::ipopt::{LinearSolver, OptionValue};
use crate::math::{Random, Signal, shortest};
use crate::model::system::{Fidelity, Muscle, Source, System};
use std::collections::BTreeMap;

/// Most intervals of a control problem; a slip of the pen asks for more.
pub(crate) const MOST_INTERVALS: usize = 1_000_000;

/// Intervals of the first grid where no number is given.
const FIRST_INTERVALS: usize = 20;

pub(crate) fn control(
    spec: &ControlSpec,
    scene: &WrittenScene<'_>,
    scope: &Scope<'_>,
) -> Result<Control> {
    let system = scene.system;
    check_alone(spec, scope)?;
    let duration = duration(&spec.duration, &scope.key("duration"))?;
    let intervals = match spec.intervals {
        Some(IntervalsSpec::Given(intervals)) => {
            let place = scope.key("intervals");
            count(intervals, "interval", MOST_INTERVALS, &place)?;
            Some(intervals)
        }
        Some(IntervalsSpec::Word(IntervalsWord::Auto)) | None => None,
    };
    let takes_voltage = system.sources().iter().any(|source| source.takes_voltage);
    if !takes_voltage && spec.load_bounds.is_empty() {
        let found = "a scene without any muscle or electrode that takes a voltage";
        let expected = format!("a muscle of {ELECTRIC_KEYS}, or a driven electrode");
        return Err(scope.wrong(found, expected));
    }
    let mut start = start_state(&spec.start, system, &scope.key("start"))?;
    let mut objective = objective(&spec.objective, system, &scope.key("objective"))?;
    let mut goal = goal(spec, &objective, system, scope)?;
    let place = scope.key("waypoints");
    let is_periodic = goal == BoundaryState::Periodic;
    let (waypoints, near) = waypoints(&spec.waypoints, (duration, is_periodic), system, &place)?;
    objective.quantities.extend(near);
    let parameters = parameters(&spec.free, scene, &scope.key("free"))?;
    let loads = loads(&spec.loads, system, &scope.key("loads"))?;
    let load_bounds = load_bounds(&spec.load_bounds, &loads, system, &scope.key("load_bounds"))?;
    check_end((&loads, &goal), system, duration, &scope.key("loads"))?;
    load(&mut start, &loads, 0.0);
    load(&mut goal, &loads, duration.first());
    let (mut given, course) = given_voltages(spec, system, &scope.key("voltages"))?;
    let sources = system.sources().into_iter().enumerate();
    let mut sought = sources.filter(|(s, source)| source.takes_voltage && !given.contains_key(s));
    let seeks_voltage = course.is_none() && sought.next().is_some();
    let voltage_bounds = voltage_bounds(spec, seeks_voltage, scope)?;
    for (key, state) in [("start", &start), ("goal", &goal)] {
        let is_given = |s: usize| course.is_some() || given.contains_key(&s);
        check_rest_voltages(state, system, is_given, voltage_bounds, &scope.key(key))?;
    }
    given.extend(absent_loads(system, |source| {
        loads.contains_key(&source) || load_bounds.contains_key(&source)
    }));
    given.extend(loads);
    check_final_conditions(&goal, system, &scope.key("goal"))?;
    let limits = limits(&spec.limits, system, &scope.key("limits"))?;
    let guess = match &spec.guess {
        Some(guess_spec) => guess(guess_spec, system, voltage_bounds, &scope.key("guess"))?,
        None => unwritten(&goal, system),
    };
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
        coordinates: coordinates(spec.coordinates, system, scope)?,
        guess,
        solver: solver(&spec.solver, &scope.key("solver"))?,
    };
    let place = scope.key("objective").key("peak_voltage");
    let control = with_peak(control, spec.objective.peak_voltage, system, &place)?;
    with_varied(control, &spec.sensitivity, scene, &scope.key("sensitivity"))
}

/// The goal; free where none is written and the objective names what to follow or where to end.
fn goal(
    spec: &ControlSpec,
    objective: &Objective,
    system: &System,
    scope: &Scope<'_>,
) -> Result<BoundaryState> {
    match &spec.goal {
        Some(goal) => goal_state(goal, system, &scope.key("goal")),
        None if objective.quantities.is_empty()
            && spec.waypoints.iter().all(|point| point.weight.is_none()) =>
        {
            let expected = "the key \"goal\", or an objective that names something to \"track\" or a \"final\" place, or a waypoint with a weight";
            Err(scope.wrong("no key \"goal\"", expected))
        }
        None => Ok(BoundaryState::Free),
    }
}

/// The problem with the cost of the peak voltage, where that has a weight.
fn with_peak(
    mut control: Control,
    weight: f64,
    system: &System,
    scope: &Scope<'_>,
) -> Result<Control> {
    if weight > 0.0 && !control.minimise_peak_voltage(weight, system) {
        let found = "a weight where all voltages are given";
        return Err(scope.wrong(found, "a voltage that is sought"));
    }
    Ok(control)
}

pub(crate) fn duration(spec: &DurationSpec, scope: &Scope<'_>) -> Result<Duration> {
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

/// Bounds of voltages; needed where one is sought.
pub(crate) fn voltage_bounds(
    spec: &ControlSpec,
    is_needed: bool,
    scope: &Scope<'_>,
) -> Result<[f64; 2]> {
    let Some([lower, upper]) = &spec.voltage_bounds else {
        return match is_needed {
            true => Err(scope.wrong(
                "no key \"voltage_bounds\"",
                "the bounds of the voltages that are sought",
            )),
            false => Ok([0.0; 2]),
        };
    };
    let scope = scope.key("voltage_bounds");
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

/// Voltages that are given, source by source or all of them in intervals of time; one is left to be sought, unless a constant of
/// the scene is sought.
pub(crate) fn given_voltages(
    spec: &ControlSpec,
    system: &System,
    scope: &Scope<'_>,
) -> Result<(BTreeMap<usize, Signal>, Option<Voltages>)> {
    let sources = system.sources();
    let mut given = BTreeMap::new();
    let mut course = None;
    match &spec.voltages {
        VoltagesSpec::Signals(map) => {
            for (name, spec) in map {
                let scope = scope.key(name);
                let source = driven(name, &sources, &scope)?;
                given.insert(source, signal(spec, &Voltage::kind(), &scope)?);
            }
        }
        other => course = Some(over_time(other, system, scope)?),
    }
    let jumps = matches!(course, Some(Voltages::Sampled { .. }));
    if jumps && matches!(spec.duration, DurationSpec::Free(_)) {
        let found = "voltages that jump from interval to interval where the duration is free";
        let expected = "functions of time by the names of sources, or a given duration";
        return Err(scope.wrong(found, expected));
    }
    let is_sought =
        |s: usize| sources[s].takes_voltage && course.is_none() && !given.contains_key(&s);
    let seeks_load = !spec.load_bounds.is_empty();
    if (0..sources.len()).any(is_sought) || seeks_load || !spec.free.is_empty() {
        return Ok((given, course));
    }
    let expected = "at least one voltage that is not given, to be sought, or a constant of the scene under \"free\"";
    Err(scope.wrong("all voltages", expected))
}

/// Rest voltages of sources that are sought lie in the bounds.
pub(crate) fn check_rest_voltages(
    state: &BoundaryState,
    system: &System,
    is_given: impl Fn(usize) -> bool,
    [lower, upper]: [f64; 2],
    scope: &Scope<'_>,
) -> Result<()> {
    let BoundaryState::RestAtVoltages(voltages, _) = state else {
        return Ok(());
    };
    for (s, (source, &voltage)) in system.sources().iter().zip(voltages).enumerate() {
        let outside = voltage < lower || voltage > upper;
        if outside && source.takes_voltage && !is_given(s) {
            let place = scope.key("rest_at_voltages").key(&source.name);
            let found = format!("{} V", shortest(voltage, 9));
            let expected = format!("a voltage within the bounds {lower} V to {upper} V");
            return Err(place.wrong(found, expected));
        }
    }
    Ok(())
}

/// No more final conditions than degrees of freedom, where these can be counted from the joints: nodes bring more.
pub(crate) fn check_final_conditions(
    goal: &BoundaryState,
    system: &System,
    scope: &Scope<'_>,
) -> Result<()> {
    let lumped = |muscle: &Muscle| muscle.fidelity == Fidelity::Lumped;
    if !system.solids.is_empty() || !system.muscles.iter().all(lumped) {
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
    match tree_freedoms(system.bodies.len(), &system.joints) {
        Some(freedoms) if conditions > freedoms => {
            let found = format!("{conditions} final conditions on positions");
            let expected = format!("no more than the {freedoms} degrees of freedom");
            Err(scope.key(key).wrong(found, expected))
        }
        _ => Ok(()),
    }
}

pub(crate) fn objective(
    spec: &ObjectiveSpec,
    system: &System,
    scope: &Scope<'_>,
) -> Result<Objective> {
    let weights = [
        ("effort", spec.effort),
        ("rate", spec.rate),
        ("duration", spec.duration),
        ("peak_voltage", spec.peak_voltage),
        ("muscle_volume", spec.muscle_volume),
        ("muscle_mass", spec.muscle_mass),
    ];
    for (key, weight) in weights {
        scope.key(key).weight(weight)?;
    }
    let mut quantities = Vec::new();
    for (index, spec) in spec.track.iter().enumerate() {
        quantities.extend(track(spec, system, &scope.key("track").index(index))?);
    }
    for (index, spec) in spec.at_the_end.iter().enumerate() {
        quantities.extend(at_the_end(spec, system, &scope.key("final").index(index))?);
    }
    quantities.extend(amount_costs(
        [spec.muscle_volume, spec.muscle_mass],
        system,
        scope,
    )?);
    let mut of_sources = Vec::new();
    for (key, energy, weight) in [
        (
            "electrical_energy",
            SourceEnergy::Electrical,
            &spec.electrical_energy,
        ),
        (
            "mechanical_work",
            SourceEnergy::Mechanical,
            &spec.mechanical_work,
        ),
    ] {
        of_sources.extend(energies(weight, energy, system, &scope.key(key))?);
    }
    let is_any = !quantities.is_empty() || !of_sources.is_empty();
    if !is_any && weights.iter().all(|(_, weight)| *weight == 0.0) {
        let expected = "a positive weight of \"effort\", \"rate\", \"duration\", \"peak_voltage\", \"muscle_volume\", \"muscle_mass\", \"electrical_energy\" or \"mechanical_work\", or something to \"track\" or a \"final\" place";
        return Err(scope.wrong("no weight", expected));
    }
    Ok(Objective {
        effort: spec.effort,
        rate: spec.rate,
        duration: spec.duration,
        quantities,
        energies: of_sources,
    })
}

pub(crate) fn solver(spec: &SolverSpec, scope: &Scope<'_>) -> Result<Solver> {
    let default = Solver::default();
    let tolerance = spec.tolerance.unwrap_or(default.tolerance);
    if tolerance <= 0.0 {
        let expected = "a positive tolerance";
        return Err(scope
            .key("tolerance")
            .wrong(tolerance.to_string(), expected));
    }
    let max_iterations = spec.max_iterations.unwrap_or(default.max_iterations);
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
    let linear_solver = linear_solver(spec, scope)?;
    Ok(Solver {
        tolerance,
        max_iterations,
        linear_solver,
        ipopt: spec.ipopt.iter().map(option).collect(),
    })
}

/// Reads the solver of the linear systems; named once.
fn linear_solver(spec: &SolverSpec, scope: &Scope<'_>) -> Result<LinearSolver> {
    let Some(named) = spec.linear_solver else {
        return Ok(LinearSolver::Auto);
    };
    if let Some(OptionSpec::Text(other)) = spec.ipopt.get("linear_solver") {
        let expected = "one linear solver: \"linear_solver\" of \"solver\" names another one";
        let place = scope.key("ipopt").key("linear_solver");
        return Err(place.wrong(format!("{other:?}"), expected));
    }
    Ok(match named {
        ControlSolverSpec::Auto => LinearSolver::Auto,
        ControlSolverSpec::Stages => LinearSolver::Stages,
        ControlSolverSpec::Mumps => LinearSolver::Mumps,
    })
}

/// Names that an energy may have, for messages: the charge of an electrode of finite elements is not known at instants.
const LUMPED: &str =
    "lumped muscles: all sources, or those that \"sources\" names beside the \"weight\"";

/// The costs that one weight stands for; none where it is zero.
pub(crate) fn energies(
    spec: &EnergySpec,
    energy: SourceEnergy,
    system: &System,
    scope: &Scope<'_>,
) -> Result<Vec<EnergyCost>> {
    let sources = system.sources();
    let cost = |source: usize, weight: f64, place: &Scope<'_>| {
        let cost = EnergyCost {
            source,
            energy,
            weight,
        };
        let muscle = system.muscles.get(source);
        let what = match muscle.and_then(|muscle| muscle.circuit) {
            Some(circuit) if circuit.resistance.is_none() => "leaks and has no resistor",
            Some(_) => "has a resistor",
            None => "drives finite elements",
        };
        let found = || format!("{:?}, which {what}", sources[source].name);
        match cost.exists(system) {
            true => Ok(cost),
            false => Err(place.wrong(found(), LUMPED)),
        }
    };
    match spec {
        EnergySpec::All(weight) => {
            let weight = scope.weight(*weight)?;
            let takes = |s: &usize| sources[*s].takes_voltage && weight > 0.0;
            let all = (0..sources.len()).filter(takes);
            all.map(|source| cost(source, weight, scope)).collect()
        }
        EnergySpec::Named(spec) => {
            let weight = scope.key("weight").weight(spec.weight)?;
            let list = scope.key("sources");
            if spec.sources.is_empty() {
                return Err(list.wrong("no source", "one source or more"));
            }
            let mut costs: Vec<EnergyCost> = Vec::new();
            for (index, name) in spec.sources.iter().enumerate() {
                let place = list.index(index);
                let source = driven(name, &sources, &place)?;
                if costs.iter().any(|cost| cost.source == source) {
                    return Err(place.wrong(format!("{name:?} again"), "each source once"));
                }
                costs.push(cost(source, weight, &place)?);
            }
            costs.retain(|cost| cost.weight > 0.0);
            Ok(costs)
        }
    }
}

pub(crate) fn guess(
    spec: &GuessSpec,
    system: &System,
    bounds: [f64; 2],
    scope: &Scope<'_>,
) -> Result<Guess> {
    let GuessSpec::Object(spec) = spec else {
        return Ok(Guess::Interpolate);
    };
    type Build<'a> = Box<dyn FnOnce() -> Result<Guess> + 'a>;
    let simulate = spec.simulate.as_ref().map(|simulate| -> Build<'_> {
        let scope = scope.key("simulate").key("voltages");
        Box::new(move || over_time(&simulate.voltages, system, &scope).map(Guess::Simulate))
    });
    let solution = spec.solution.as_ref().map(|solution| -> Build<'_> {
        let scope = scope.key("solution");
        Box::new(move || {
            let path = scope.solution_file(solution, SOLUTION_PATH)?;
            Ok(Guess::Solution(Earlier::new(SolutionFile(path))))
        })
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
