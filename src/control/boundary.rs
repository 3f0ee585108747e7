//! Start and goal: the coordinates that they give, the equations that they add, and the voltages at rest.
//!
//! Inputs that hold a goal, sought with the motion: the goal is a state of rest, and one interval behind the motion keeps it.
//!
//! In an interval whose ends have the same coordinates q nothing moves, and both discrete forces are the static ones, −h/2 ∂V/∂q(q, u).
//! With the rest of the motion before it, the balances of the instants N and N + 1 say that q is an equilibrium under the inputs u of that interval:
//!
//! ```text
//! D₂L_d(q_{N−1}, q_N) + D₁L_d(q_N, q_N; u) = 0,     D₂L_d(q_N, q_N; u) = 0.
//! ```
//!
//! Places and orientations of a goal or a waypoint as equations of one instant, without those that nothing can change.

use crate::control::boundary_conditions::{
    BoundaryConditions, Rests, TerminalState, check_muscles, of_masses, resolve_start, rest_at,
};
use crate::control::costs::{resisted, sources};
use crate::control::error::BoundaryError;
use crate::control::goal::{Orientation, Place, Product, instant_at};
use crate::control::limits::{BoundedQuantity, Length, Limits, When};
use crate::control::prescribed::at_rest;
use crate::control::problem::{BoundaryState, Control, Duration, During, Rest, SoughtHold};
use crate::control::transcription::Site;
use crate::control::transcription::layout::Layout;
use crate::control::transcription::structure::overdetermined;
use crate::control::{endpoint_checks, free_parameters, prescribed};
use crate::dynamics::{Equilibrium, Start};
use crate::functional::Sample;
use crate::math::{Random, Vector, shortest};
use crate::model::{Analysis, Coordinates, Graph, Model, Presolved, Quantity, System, What};
use std::collections::BTreeMap;

impl BoundaryConditions {
    /// Builds the model of a control problem and resolves its start and goal.
    ///
    /// # Errors
    /// The model does not exist in the coordinates, or a state of rest does not exist.
    pub fn resolve(
        system: &System,
        control: &Control,
        h0: f64,
    ) -> Result<(Model, Self), BoundaryError> {
        let (model, boundary) = Self::with_parameters(system, control, h0, false)?;
        let goal = match model.solids.is_empty() {
            true => None,
            false => control.goal.resting(Rest::Bodies),
        };
        let Some(goal) = goal else {
            return Ok((model, boundary));
        };
        let layout = Layout::new(&model, &boundary, control, control.intervals);
        let Some(error) = overdetermined(&layout, &model, control.intervals) else {
            return Ok((model, boundary));
        };
        let names_markers = matches!(goal, BoundaryState::Markers { .. });
        if !names_markers && model.action.map.of_bodies == 0 {
            return Err(error);
        }
        let eased = Control {
            goal,
            ..control.clone()
        };
        let (model, mut boundary) = Self::with_parameters(system, &eased, h0, false)?;
        boundary.notes.push(format!(
            "{} voltages cannot bring all {} coordinates of elastic blocks and bodies to rest: at the goal {} rest, as by \"rest\": \"bodies\"",
            layout.sought_inputs(),
            model.coordinate_count(),
            if names_markers { "bodies and its markers" } else { "bodies" },
        ));
        Ok((model, boundary))
    }

    /// Resolves like [`resolve`](Self::resolve) for parameters that keep their guesses: states of rest may depend on them. What rests at the goal is
    /// what the goal says.
    ///
    /// # Errors
    /// As of [`resolve`](Self::resolve).
    pub fn resolve_held(
        system: &System,
        control: &Control,
        h0: f64,
    ) -> Result<(Model, Self), BoundaryError> {
        Self::with_parameters(system, control, h0, true)
    }

    /// Model and boundary; parameters are held at their guesses where `are_held`.
    fn with_parameters(
        system: &System,
        control: &Control,
        h0: f64,
        are_held: bool,
    ) -> Result<(Model, Self), BoundaryError> {
        let system = &free_parameters::at_guess(system, control)?;
        let analysis = control.analysis(system, h0);
        let presolved = Presolved::new(system, &analysis);
        let coordinates = control.coordinates.unwrap_or(Coordinates::Reduced);
        let are_independent = coordinates.are_independent(&Graph::new(&presolved.system));
        let limits = limits_with_goal(system, control, !are_independent);
        let analysis = Analysis {
            coordinates: Some(coordinates),
            ..with_quantities(analysis, &limits, control, system)
        };
        let mut model = Model::of_presolved(system.clone(), analysis, presolved)?;
        check_sought_hold(&model, control)?;
        prescribed::check_periodic(&model, control)?;
        let rests = rests_at(&control.goal);
        prescribed::check_end_of_motions(&model, control, rests != Rests::Nothing)?;
        let (mut start, mut of_start) = start_of(&model, &control.start)?;
        if control.continues[0] {
            // Only the solver begins there.
            (start, of_start) = (Start::at_rest(&model, start.z), None);
        }
        leave_out_constant(&mut model, &limits, &start.z)?;
        let (mut given, of_goal) = coordinates_at_goal(&model, control)?;
        prescribed::at_goal(&model, control, &mut given)?;
        if let Some(z) = given.iter().copied().collect::<Option<Vec<f64>>>() {
            check_muscles(&model, &z, "goal")?;
        }
        let scalars = [of_start, of_goal.as_ref().map(|rest| rest.scalars.clone())];
        let rest = match control.goal {
            BoundaryState::Periodic => [None; 2],
            _ => [&control.start, &control.goal].map(BoundaryState::voltages),
        };
        let rest = [rest[0].filter(|_| !control.continues[0]), rest[1]];
        let mut boundary = Self {
            start,
            momentum_slopes: Vec::new(),
            goal: TerminalState {
                momentum: momentum_at_goal(&model, control, &given)?,
                coordinates: given,
                rests,
                rest: of_goal,
            },
            rest: rest.map(|voltages| voltages.map(<[f64]>::to_vec)),
            sought_rest: [false; 2],
            notes: [off_grid(control), without_steps(control, &limits)].concat(),
            limits,
        };
        let rest = boundary.goal.rest.as_ref();
        let is_known = control.knows_start();
        let start = is_known.then_some(&boundary.start.z[..]);
        let ends = match are_held {
            true => [None; 2],
            false => [start, rest.map(|rest| &rest.z[..])],
        };
        boundary.sought_rest = free_parameters::check(&model, control, &boundary, ends)?;
        boundary.momentum_slopes =
            free_parameters::moving_start(&model, control, &mut boundary.start)?;
        if boundary.sought_rest[1] {
            boundary.goal.coordinates.fill(None);
        }
        endpoint_checks::check(&model, &boundary, control, scalars)?;
        prescribed::check_given_rates(system, control, &boundary.rest)?;
        Ok((model, boundary))
    }
}

/// The path limits of a problem, and the parts of its goal and its waypoints that are equations of measures.
fn limits_with_goal(system: &System, control: &Control, measure_joints: bool) -> Limits {
    let length = Length {
        h: control.duration.first() / control.intervals as f64,
        is_free: matches!(control.duration, Duration::Free { .. }),
    };
    let mut limits = Limits::new(&control.limits, system, measure_joints, length);
    match &control.goal {
        BoundaryState::Markers {
            places,
            orientations,
            rest,
            ..
        } => {
            add_places(&mut limits, system, places, When::Goal, "goal");
            if *rest == Rest::Bodies {
                add_rest(&mut limits, system, places.keys());
            }
            add_orientations(&mut limits, system, orientations, When::Goal, "goal");
        }
        goal @ BoundaryState::JointAngles { angles, .. }
            if measure_joints && !all_joints_given(system, goal) =>
        {
            for (&joint, &near) in angles {
                let name = format!("goal of {}", system.joints[joint].name);
                let quantity = Quantity::joint(joint, near);
                limits.add_at(When::Goal, quantity, [near; 2], name);
            }
        }
        _ => {}
    }
    for waypoint in &control.waypoints {
        let (when, at) = (When::At(waypoint.part), waypoint.name.as_str());
        add_places(&mut limits, system, &waypoint.places, when, at);
        add_orientations(&mut limits, system, &waypoint.orientations, when, at);
        for (&joint, &near) in &waypoint.angles {
            let name = format!("{at} coordinate of {}", system.joints[joint].name);
            limits.add_at(when, Quantity::joint(joint, near), [near; 2], name);
        }
    }
    free_parameters::in_intervals(&mut limits, control);
    limits
}

/// The analysis with the quantities of limits, goal and costs.
fn with_quantities(
    analysis: Analysis,
    limits: &Limits,
    control: &Control,
    system: &System,
) -> Analysis {
    let mut quantities = limits.quantities();
    let paid = &control.objective.quantities;
    let curved = paid.iter().enumerate().filter(|(_, c)| c.is_curved());
    let curved = curved.map(|(i, _)| quantities.len() + i).collect();
    quantities.extend(paid.iter().map(|cost| cost.quantity.clone()));
    let energies = &control.objective.energies;
    quantities.extend(resisted(energies, system).map(|cost| cost.integral().quantity));
    let charged = sources(energies, system).into_iter();
    quantities.extend(charged.map(|muscle| Quantity::of(What::Capacitance(muscle))));
    Analysis {
        curved,
        quantities,
        ..analysis
    }
}

/// The start, and the scalars of an interval there, where it is a state of rest under voltages.
fn start_of(
    model: &Model,
    start: &BoundaryState,
) -> Result<(Start, Option<Vec<f64>>), BoundaryError> {
    match start {
        BoundaryState::RestAtVoltages(voltages, _) => {
            let rest = rest_at(model, voltages, "start", 0.0)?;
            Ok((at_rest(model, rest.z)?, Some(rest.scalars)))
        }
        state => Ok((resolve_start(model, state)?, None)),
    }
}

/// Coordinates that a goal gives, and its equilibrium, where it is one.
fn coordinates_at_goal(
    model: &Model,
    control: &Control,
) -> Result<(Vec<Option<f64>>, Option<Equilibrium>), BoundaryError> {
    let n = model.coordinate_count();
    let goal = &control.goal;
    let mut given = vec![None; n];
    match goal {
        BoundaryState::RestAtVoltages(voltages, of) => {
            let rest = rest_at(model, voltages, "goal", control.duration.first())?;
            let reached = match of {
                Rest::Everything | Rest::Attainable => n,
                Rest::Bodies => model.action.map.of_bodies.min(n),
            };
            for (given, value) in given.iter_mut().zip(&rest.z[..reached]) {
                *given = Some(*value);
            }
            forget(model, &mut given, |i| {
                is_set_at(model, control, voltages, i)
            });
            return Ok((given, Some(rest)));
        }
        BoundaryState::JointAngles { angles, .. } if model.has_independent_joints() => {
            for (&joint, &value) in angles {
                if let Some(c) = model.joint_readings[joint].coordinate {
                    given[c] = Some(value);
                }
            }
        }
        BoundaryState::JointAngles { angles, .. } if all_joints_given(&model.system, goal) => {
            let joints: Vec<f64> = (0..model.system.joints.len())
                .map(|j| angles.get(&j).copied().unwrap_or(0.0))
                .collect();
            let z = model.coordinates_at(&joints);
            given = z[..n].iter().copied().map(Some).collect();
            forget(model, &mut given, |_| false);
        }
        _ => {}
    }
    Ok((given, None))
}

/// Momentum of each coordinate at a goal with rates; none of another one.
fn momentum_at_goal(
    model: &Model,
    control: &Control,
    given: &[Option<f64>],
) -> Result<Vec<f64>, BoundaryError> {
    if !control.goal.has_rates() {
        return Ok(Vec::new());
    }
    let refused = |reason: &str| Err(BoundaryError::refused("goal.joint_rates", reason));
    let is_open = |(i, given): (usize, &Option<f64>)| given.is_none() && !model.is_memory(i);
    if given.iter().enumerate().any(is_open) || !model.prescribed.is_empty() {
        return refused(
            "rates at the end need a goal that gives the coordinates of all joints, in a scene without nodes of blocks that move, closed loops and \
             prescribed motions",
        );
    }
    if !of_masses(model).is_empty() {
        return refused("rates at the end are for given masses: their momenta are constants");
    }
    Ok(resolve_start(model, &control.goal)?.momentum)
}

/// Returns true if a goal under voltages sets a coordinate that muscles remember. A voltage that is sought charges its muscle in finite time,
/// unless it rests at a bound; nothing sets at once what others remember.
pub(super) fn is_set_at(model: &Model, control: &Control, voltages: &[f64], i: usize) -> bool {
    let [low, high] = control.voltage_bounds;
    let is_between = |m: usize| low < voltages[m] && voltages[m] < high;
    let muscle = model.charge(i);
    muscle.is_some_and(|m| !control.is_given(m) && is_between(m))
}

/// Prescribes nothing of what muscles remember, unless it is set.
fn forget(model: &Model, given: &mut [Option<f64>], is_set: impl Fn(usize) -> bool) {
    for (i, given) in given.iter_mut().enumerate() {
        if model.is_memory(i) && !is_set(i) {
            *given = None;
        }
    }
}

/// Part of the system that rests at a goal.
fn rests_at(goal: &BoundaryState) -> Rests {
    match goal {
        BoundaryState::Free | BoundaryState::Periodic => Rests::Nothing,
        BoundaryState::Markers {
            rest: Rest::Bodies, ..
        }
        | BoundaryState::RestAtVoltages(_, Rest::Bodies) => Rests::Bodies,
        _ => Rests::Everything,
    }
}

/// Returns true if a goal gives all coordinates of a tree, each the only one of its joint.
fn all_joints_given(system: &System, goal: &BoundaryState) -> bool {
    let BoundaryState::JointAngles { angles, .. } = goal else {
        return false;
    };
    let coordinates = system.joint_coordinates();
    let mut coordinates = coordinates.iter().enumerate();
    Graph::new(system).has_one_coordinate_a_joint(system)
        && coordinates.all(|(j, c)| c.is_none() || angles.contains_key(&j))
}

/// Parts of an interval by which a waypoint may miss an instant.
const OFF: f64 = 1e-6;

/// Verb of the notes about waypoints.
const REACHED: &str = "is reached";

/// Notes about waypoints and limits at a time that lie between two instants.
pub(super) fn off_grid(control: &Control) -> Vec<String> {
    let count = control.intervals;
    let note = |name: String, part: f64, verb: &str| {
        let k = instant_at(part, count);
        let at = match control.duration {
            Duration::Given(duration) => {
                let time = k as f64 / count as f64 * duration / 1e3;
                format!("{} s", shortest(time, 4))
            }
            Duration::Free { .. } => format!("instant {k} of {count}"),
        };
        ((part * count as f64 - k as f64).abs() > OFF)
            .then(|| format!("{name} lies between two instants: it {verb} at {at}"))
    };
    let exact = control.waypoints.iter();
    let exact = exact.filter_map(|waypoint| note(waypoint.name.clone(), waypoint.part, REACHED));
    let costs = control.objective.quantities.iter();
    let near = costs.filter_map(|cost| match cost.during {
        During::At(part) => note(
            format!("waypoint at {} of the duration", shortest(part, 6)),
            part,
            REACHED,
        ),
        During::Motion | During::End => None,
    });
    let limits = control.limits.iter().filter_map(|limit| {
        let part = limit.part?;
        let name = format!("limit at {} of the duration", shortest(part, 6));
        note(name, part, "holds")
    });
    let mut notes: Vec<String> = exact.chain(near).chain(limits).collect();
    notes.dedup();
    notes
}

/// Notes about limits of steps between intervals, of which one interval has none.
pub(super) fn without_steps(control: &Control, limits: &Limits) -> Vec<String> {
    let steps = limits.list.iter().filter(|_| control.intervals == 1);
    let steps = steps.filter(|bounded| bounded.quantity.before().is_some());
    let note = |bounded: &BoundedQuantity| {
        let name = &bounded.name;
        format!(
            "the {name} is limited from one interval to the next: one interval has no such step"
        )
    };
    let mut notes: Vec<String> = steps.map(note).collect();
    notes.dedup();
    notes
}

impl Control {
    /// Returns true if the start is known: it is neither that of a period nor the end of another motion.
    pub fn knows_start(&self) -> bool {
        self.goal != BoundaryState::Periodic && !self.continues[0]
    }

    /// Returns true if the inputs that hold the goal are sought with the motion.
    pub fn seeks_hold(&self) -> bool {
        self.sought_hold == SoughtHold::Always
    }

    /// Returns true if the goal names places or joint coordinates and no voltages that hold it.
    pub fn names_no_hold(&self) -> bool {
        match &self.goal {
            goal @ BoundaryState::JointAngles { .. } => !goal.has_rates(),
            BoundaryState::Markers { hold, .. } => hold.is_none(),
            _ => false,
        }
    }
}

/// The reason why nothing that holds a goal can be sought: nodes and what muscles remember have no rest of their own there.
pub(crate) fn obstacle(model: &Model, control: &Control) -> Option<&'static str> {
    if !control.names_no_hold() {
        return Some(
            "inputs that hold a goal are sought for places or joint coordinates without given ones",
        );
    }
    if !model.solids.is_empty() {
        return Some(
            "\"find\" is for lumped muscles: a few voltages cannot hold every node of an elastic block where the motion leaves it; name the voltages",
        );
    }
    let from = match control.duration {
        Duration::Given(end) => end,
        Duration::Free { min, .. } => min,
    };
    let mut functions = (0..model.sources.len()).filter_map(|source| control.function(source));
    if functions.any(|function| function.constant_within([from, f64::INFINITY]).is_none()) {
        return Some(
            "\"find\" is for given inputs that are constant from the end on: nothing rests under one that goes on",
        );
    }
    model.creeps().then_some(
        "\"find\" is for muscles that do not creep: no constant voltages keep a stretch that relaxes",
    )
}

/// Refuses to seek what holds a goal where nothing can.
pub(super) fn check_sought_hold(model: &Model, control: &Control) -> Result<(), BoundaryError> {
    let reason = match control.seeks_hold() {
        true => obstacle(model, control),
        false => None,
    };
    reason.map_or(Ok(()), |reason| {
        Err(BoundaryError::refused("goal.hold", reason))
    })
}

const AXES: [&str; 3] = ["x", "y", "z"];
/// Configurations at which a gradient has to vanish.
const TRIALS: u64 = 3;
/// Distance of these from the start, in rad and lengths of the system.
const NEAR: f64 = 0.3;
/// A gradient of this size is rounding.
const ROUNDING: f64 = 1e-12;

/// Adds the equations of places of markers at a single instant, called `at` in messages.
fn add_places(
    limits: &mut Limits,
    system: &System,
    places: &BTreeMap<usize, Place>,
    when: When,
    at: &str,
) {
    for (&marker, place) in places {
        let name = &system.markers[marker].name;
        let is_free = |axis: usize| !system.holds_marker(marker, axis);
        for (axis, value) in place.given().filter(|(axis, _)| is_free(*axis)) {
            let name = format!("{at} {} of marker {name}", AXES[axis]);
            let quantity = Quantity::marker_place(marker, axis);
            limits.add_at(when, quantity, [value; 2], name);
        }
    }
}

/// Adds the equations of the rest of markers at the goal.
fn add_rest<'p>(limits: &mut Limits, system: &System, markers: impl Iterator<Item = &'p usize>) {
    for &marker in markers {
        let name = &system.markers[marker].name;
        for axis in (0..3).filter(|&axis| !system.holds_marker(marker, axis)) {
            let name = format!("rest at the goal, {} of marker {name}", AXES[axis]);
            let quantity = Quantity::step(What::Place { marker, axis }, 1.0);
            limits.add_at(When::Goal, quantity, [0.0; 2], name);
        }
    }
}

/// Adds the conditions of orientations of bodies at a single instant, called `at` in messages.
fn add_orientations(
    limits: &mut Limits,
    system: &System,
    orientations: &BTreeMap<usize, Orientation>,
    when: When,
    at: &str,
) {
    for (&body, orientation) in orientations {
        let name = format!("{at} orientation of body {}", system.bodies[body].name);
        for Product {
            axis,
            along,
            is_acute,
        } in orientation.products()
        {
            let quantity = Quantity::of(What::Direction { body, axis, along });
            let upper = if is_acute { f64::INFINITY } else { 0.0 };
            limits.add_at(when, quantity, [0.0, upper], name.clone());
        }
    }
}

/// Leaves out directions at the goal that no joint coordinate changes, such as those across the plane of a plane robot: as
/// equations they would have no slope. A direction that is not kept by itself is refused.
///
/// # Errors
/// Nothing turns a direction to where the goal wants it.
fn leave_out_constant(
    model: &mut Model,
    limits: &Limits,
    start: &[f64],
) -> Result<(), BoundaryError> {
    if model.coordinates != Coordinates::Reduced {
        return Ok(());
    }
    for (index, bounded) in limits.list.iter().enumerate() {
        let is_direction = matches!(bounded.quantity.what, What::Direction { .. });
        let Some(measure) = model.measured[index] else {
            continue;
        };
        if !bounded.when.is_single() || !is_direction || changes(model, measure, start) {
            continue;
        }
        let instant = model.action.map.placed(start);
        let measure = Site::Instants.measure(model, measure);
        let value = measure.value(&Sample::of_instant(&instant.x, &[]));
        if let Some(reason) = bounded.broken(value, &model.system) {
            let reason = format!("{reason}; no joint changes it");
            return Err(BoundaryError::refused("goal", reason));
        }
        model.measured[index] = None;
    }
    Ok(())
}

/// Returns true if coordinates change a quantity of the instants somewhere.
fn changes(model: &Model, measure: usize, start: &[f64]) -> bool {
    let map = &model.action.map;
    let measure = Site::Instants.measure(model, measure);
    let length = model.length();
    (0..TRIALS).any(|seed| {
        let mut random = Random::new(seed);
        let mut z = start.to_vec();
        for (i, value) in z[..map.of_bodies].iter_mut().enumerate() {
            let size = if model.is_length(i) { length } else { 1.0 };
            *value += random.between(-NEAR, NEAR) * size;
        }
        let mut instant = map.placed(&z);
        map.tangent(&mut instant);
        let zeros = || vec![Vector::zeros(); instant.x.len()];
        let (mut forces, mut rows) = ([zeros(), zeros()], Vec::new());
        measure.gradient(&Sample::of_instant(&instant.x, &[]), &mut forces, &mut rows);
        let mut slopes = vec![0.0; map.unknowns()];
        for vector in measure.vectors() {
            map.pull_back_one(vector, &instant.columns, &forces[0][vector], &mut slopes);
        }
        slopes.iter().any(|slope| slope.abs() > ROUNDING)
    })
}
