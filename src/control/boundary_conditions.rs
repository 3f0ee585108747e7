//! Boundary conditions of a motion: its start and its terminal state.
//!
//! States that a problem gives: coordinates and momenta of a start, also where masses are sought; checks of coordinates; a motion under given inputs.
//!
//! The momentum p = M(q, π) q̇ of given coordinates and rates is linear in masses, densities and moments of inertia: its values at two values
//! of a parameter tell its slope, a third one that it is a straight line, and one with all parameters changed that it is linear in them
//! together.

use crate::control::error::BoundaryError;
use crate::control::inputs::Voltages;
use crate::control::limits::Limits;
use crate::control::prescribed::{self, at_rest};
use crate::control::problem::{
    BoundaryState, Control, Duration, Guess, Hold, Objective, Solver, SoughtHold,
};
use crate::dynamics::{Equilibrium, Start, part_without_energy, stable_equilibrium};
use crate::functional::{Order, TermKind};
use crate::model::{
    Analysis, Model, ModelError, Parameter, Prescribed, Presolved, Role, with_parameters,
};
use std::collections::BTreeMap;

/// A control problem's model with its start and goal.
#[derive(Clone, Debug)]
pub struct BoundaryConditions {
    /// Start of the motion.
    pub start: Start,
    /// Changes of its momenta with sought masses.
    pub momentum_slopes: Vec<MomentumSlopes>,
    /// End of the motion.
    pub goal: TerminalState,
    /// Voltages at rest before the start and after the goal (V, one per muscle), where known.
    pub rest: [Option<Vec<f64>>; 2],
    /// True of the start, and of the goal, where it is a state of rest that depends on free parameters: its coordinates are unknowns.
    pub sought_rest: [bool; 2],
    /// Limits and goal equations.
    pub limits: Limits,
    /// Notes on both.
    pub notes: Vec<String>,
}

impl BoundaryConditions {
    /// A start in a number of coordinates, and an open end.
    pub fn without_goal(start: Start, coordinates: usize) -> Self {
        Self {
            start,
            momentum_slopes: Vec::new(),
            goal: TerminalState {
                coordinates: vec![None; coordinates],
                momentum: Vec::new(),
                rests: Rests::Nothing,
                rest: None,
            },
            rest: [None, None],
            sought_rest: [false; 2],
            limits: Limits::default(),
            notes: Vec::new(),
        }
    }
}

/// Derivatives of the momenta of a start by a parameter.
#[derive(Clone, Debug, PartialEq)]
pub struct MomentumSlopes {
    /// Index of the parameter.
    pub parameter: usize,
    /// Its value at the start.
    pub value: f64,
    /// A derivative for each coordinate.
    pub slopes: Vec<f64>,
}

/// Part of the system that comes to rest at the end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rests {
    /// Every coordinate.
    Everything,
    /// Bodies, and nodes that are held to them.
    Bodies,
    /// Nothing.
    Nothing,
}

/// The final state, with these coordinates given.
#[derive(Clone, Debug, PartialEq)]
pub struct TerminalState {
    /// Given coordinates; `None` where the optimisation decides.
    pub coordinates: Vec<Option<f64>>,
    /// Momentum of each coordinate where the motion ends with given rates; none where it rests or anything may be.
    pub momentum: Vec<f64>,
    /// Part of the system that rests, or has these momenta.
    pub rests: Rests,
    /// The equilibrium that it is, where it is one under voltages that are named.
    pub rest: Option<Equilibrium>,
}

impl TerminalState {
    /// Charts of the equilibrium, behind this number of unknowns; none where the state is no equilibrium.
    pub fn charts(&self, unknowns: usize) -> &[f64] {
        self.rest.as_ref().map_or(&[], |rest| &rest.z[unknowns..])
    }

    /// Sets what the state gives in the coordinates of an instant, whose charts stand behind this number of unknowns.
    pub(super) fn give(&self, z: &mut [f64], unknowns: usize) {
        for (value, given) in z.iter_mut().zip(&self.coordinates) {
            *value = given.unwrap_or(*value);
        }
        let charts = z[unknowns..].iter_mut().zip(self.charts(unknowns));
        charts.for_each(|(value, chart)| *value = *chart);
    }
}

/// The equilibrium under voltages (V, one per muscle), with free parameters at their guesses and prescribed coordinates at a time in ms.
///
/// # Errors
/// There is none.
pub fn rest_at(
    model: &Model,
    voltages: &[f64],
    place: &'static str,
    time: f64,
) -> Result<Equilibrium, BoundaryError> {
    let parameters = &model.analysis.parameters;
    if parameters.is_empty() {
        return equilibrium(model, voltages, place, time);
    }
    let guesses: Vec<f64> = parameters.iter().map(|p| p.guess).collect();
    let mut found = rest_with(model, voltages, &guesses, place, time)?;
    let at = model.variables.range(Role::Parameter).start;
    found.scalars.splice(at..at, guesses);
    Ok(found)
}

/// The equilibrium with given values of the parameters: loads grow from zero, and parameters are none.
pub(super) fn rest_with(
    model: &Model,
    voltages: &[f64],
    values: &[f64],
    place: &'static str,
    time: f64,
) -> Result<Equilibrium, BoundaryError> {
    equilibrium(&with_values(model, values)?, voltages, place, time)
}

/// The model without free parameters, with values put in their places.
pub(super) fn with_values(model: &Model, values: &[f64]) -> Result<Model, ModelError> {
    let sought = &model.analysis;
    let system = with_parameters(&model.system, &sought.parameters, values);
    // What may move is that of the model.
    let presolved = Presolved::new(&system, sought);
    let given = Analysis {
        parameters: Vec::new(),
        coordinates: Some(model.coordinates),
        ..sought.clone()
    };
    Model::of_presolved(system, given, presolved)
}

fn equilibrium(
    model: &Model,
    voltages: &[f64],
    place: &'static str,
    time: f64,
) -> Result<Equilibrium, BoundaryError> {
    let zero = model.reference_coordinates_at(time);
    let found = stable_equilibrium(model, &zero, &model.scalars(voltages));
    found.map_err(|source| BoundaryError::NoEquilibrium { place, source })
}

/// Coordinates and momenta of a start.
///
/// # Errors
/// There is no equilibrium, or joint coordinates do not fit the loops of the scene.
pub fn resolve_start(model: &Model, state: &BoundaryState) -> Result<Start, BoundaryError> {
    let place = "start";
    match state {
        BoundaryState::RestAtVoltages(voltages, _) => {
            at_rest(model, rest_at(model, voltages, place, 0.0)?.z)
        }
        BoundaryState::JointAngles {
            angles,
            rates: named_rates,
            velocities,
        } => {
            let value = |one: &Prescribed| one.motion.at(0.0);
            let joints = prescribed::by_joint(model, angles, value, "coordinate")?;
            let z = model.coordinates_at(&joints);
            check_constraints(model, &z)?;
            check_muscles(model, &z, place)?;
            let rate = |one: &Prescribed| one.motion.derivatives(0.0)[1];
            let of_joints = prescribed::by_joint(model, named_rates, rate, "rate")?;
            // In closed loops joints move with the rest.
            let of_joints = match model.has_loops() {
                true => vec![0.0; of_joints.len()],
                false => of_joints,
            };
            let rates = model.rates_at(&joints, &of_joints, velocities);
            let rates = rates.map_err(|body| {
                let name = &model.system.bodies[body].name;
                let reason = format!("the motion of body \"{name}\" follows from its joints");
                BoundaryError::refused(place, reason)
            })?;
            let rates = model.rates_of_all(&rates, &of_joints);
            let bodies: Vec<usize> = velocities.keys().copied().collect();
            prescribed::in_loops(model, z, rates, named_rates.clone(), &bodies)
        }
        BoundaryState::EndOf(end) => {
            let start = end.start(model);
            let start = start.map_err(|reason| BoundaryError::refused("start.end_of", reason))?;
            check_muscles(model, &start.z, place)?;
            prescribed::check_end(model, &start.z)?;
            Ok(start)
        }
        BoundaryState::Markers { .. } | BoundaryState::Free | BoundaryState::Periodic => {
            Err(BoundaryError::refused(
                place,
                "a motion starts at joint coordinates, at rest under voltages, or at the end of another motion; free and periodic states and places of markers are goals",
            ))
        }
    }
}

/// Checks that no muscle has lost its length or its energy at coordinates.
pub(super) fn check_muscles(
    model: &Model,
    z: &[f64],
    place: &'static str,
) -> Result<(), BoundaryError> {
    match part_without_energy(model, z) {
        None => Ok(()),
        Some(reason) => Err(BoundaryError::refused(place, reason)),
    }
}

/// Checks the constraints that the coordinates leave open.
fn check_constraints(model: &Model, z: &[f64]) -> Result<(), BoundaryError> {
    let mut instant = model.action.map.placed(z);
    let mut scratch = model.action.scratch(Order::Gradient);
    model
        .action
        .evaluate_instant(Order::Gradient, &mut instant, &[], &mut scratch);
    let rows = &scratch.instant.plain.rows;
    let worst = (0..rows.len()).max_by(|&a, &b| rows[a].abs().total_cmp(&rows[b].abs()));
    let Some(worst) = worst else { return Ok(()) };
    let value = rows[worst].abs() / model.multiplier_time;
    if value > 1e-9 * model.length() {
        let name = &model.variables.with(Role::Multiplier)[worst].name;
        let reason = format!(
            "the given joint coordinates do not fit the loops of the scene: {name} is violated by {value:.3e}"
        );
        return Err(BoundaryError::refused("start", reason));
    }
    Ok(())
}

impl Control {
    /// The motion from a start under given inputs over `duration` ms, as a problem without a choice.
    pub fn of_course(
        start: &BoundaryState,
        inputs: &Voltages,
        duration: f64,
        intervals: usize,
    ) -> Self {
        Self {
            duration: Duration::Given(duration),
            intervals,
            input_intervals: 1,
            is_refined: false,
            varied: Vec::new(),
            outcomes: Vec::new(),
            start: start.clone(),
            goal: BoundaryState::Free,
            voltage_bounds: [f64::NEG_INFINITY, f64::INFINITY],
            load_bounds: BTreeMap::new(),
            given: BTreeMap::new(),
            course: Some(inputs.clone()),
            parameters: Vec::new(),
            continues: [false; 2],
            sought_hold: SoughtHold::Never,
            hold: Hold::Reported,
            objective: Objective::default(),
            limits: Vec::new(),
            waypoints: Vec::new(),
            coordinates: None,
            guess: Guess::Interpolate,
            solver: Solver::default(),
        }
    }
}

/// Differences from a straight line this small, relative to the momenta, are rounding.
const STRAIGHT: f64 = 1e-9;

/// Gives a start with rates the momenta of its masses, and returns their derivatives by the parameters; none of a start at rest.
///
/// # Errors
/// The index of a parameter with which the start changes otherwise than along a straight line in its momenta.
pub fn momentum_slopes(
    model: &Model,
    state: &BoundaryState,
    start: &mut Start,
) -> Result<Vec<MomentumSlopes>, usize> {
    if start.momentum.iter().all(|p| *p == 0.0) || matches!(state, BoundaryState::EndOf(_)) {
        return Ok(Vec::new());
    }
    let of_masses = of_masses(model);
    if let Some(&first) = of_masses.first() {
        let guess = model.analysis.parameters[first].guess;
        start.momentum = start_at(model, state, &[(first, guess)])
            .ok_or(first)?
            .momentum;
    }
    let start = &*start;
    let slopes = of_masses.into_iter().filter_map(|index| {
        let found = by_parameter(model, state, start, index);
        found.ok_or(index).transpose()
    });
    let slopes: Vec<MomentumSlopes> = slopes.collect::<Result<_, usize>>()?;
    match slopes.last() {
        Some(last) if !are_linear(model, state, start, &slopes) => Err(last.parameter),
        _ => Ok(slopes),
    }
}

/// Indices of the parameters that masses read.
pub(super) fn of_masses(model: &Model) -> Vec<usize> {
    let terms = &model.action.intervals.terms;
    let kinetic = terms.iter().filter(|term| term.kind() == TermKind::Kinetic);
    let read: Vec<usize> = kinetic.flat_map(|term| term.not_by_squares()).collect();
    let scalars = model.variables.range(Role::Parameter).enumerate();
    let of_masses = scalars.filter(|(_, s)| read.contains(s));
    of_masses.map(|(index, _)| index).collect()
}

/// Returns true if the changes by all parameters add up.
fn are_linear(
    model: &Model,
    state: &BoundaryState,
    start: &Start,
    slopes: &[MomentumSlopes],
) -> bool {
    let parameters = &model.analysis.parameters;
    let rooms = slopes
        .iter()
        .map(|one| (one.parameter, room(&parameters[one.parameter])));
    let values: Vec<(usize, f64)> = rooms
        .map(|(index, room)| (index, parameters[index].guess + room))
        .collect();
    let Some(moved) = start_at(model, state, &values) else {
        return false;
    };
    let size = largest(start).max(largest(&moved));
    let mut pairs = start.momentum.iter().zip(&moved.momentum).enumerate();
    pairs.all(|(i, (from, to))| {
        let changes = slopes
            .iter()
            .map(|one| one.slopes[i] * room(&parameters[one.parameter]));
        (from + changes.sum::<f64>() - to).abs() <= STRAIGHT * size
    })
}

fn largest(start: &Start) -> f64 {
    start.momentum.iter().fold(0.0, |most, p| p.abs().max(most))
}

/// A change of a parameter within its bounds, about as large as its guess, to the side that leaves more room.
fn room(parameter: &Parameter) -> f64 {
    let Parameter {
        lower,
        upper,
        guess,
        ..
    } = *parameter;
    let most = (upper - guess).max(guess - lower);
    let size = match (guess == 0.0, most.is_finite()) {
        (false, _) => most.min(guess.abs()),
        (true, true) => most,
        (true, false) => 1.0,
    };
    if upper - guess > guess - lower {
        size
    } else {
        -size
    }
}

/// The same by one parameter, nothing where they do not change; other parameters keep their guesses. None where they are no straight line.
fn by_parameter(
    model: &Model,
    state: &BoundaryState,
    start: &Start,
    index: usize,
) -> Option<Option<MomentumSlopes>> {
    let parameter = &model.analysis.parameters[index];
    let (guess, room) = (parameter.guess, room(parameter));
    let at = |part: f64| start_at(model, state, &[(index, guess + part * room)]);
    let (half, whole) = (at(0.5)?, at(1.0)?);
    let size = largest(start).max(largest(&whole));
    let is_same = |a: &f64, b: &f64| (a - b).abs() <= STRAIGHT * a.abs().max(b.abs());
    let moves = [&half, &whole]
        .iter()
        .any(|other| !other.z.iter().zip(&start.z).all(|(a, b)| is_same(a, b)));
    let pairs = start
        .momentum
        .iter()
        .zip(&half.momentum)
        .zip(&whole.momentum);
    let bends = pairs
        .clone()
        .any(|((a, b), c)| (a - 2.0 * b + c).abs() > STRAIGHT * size);
    if moves || bends {
        return None;
    }
    let slopes: Vec<f64> = pairs.map(|((a, _), c)| (c - a) / room).collect();
    let changes = slopes
        .iter()
        .any(|slope| (slope * room).abs() > STRAIGHT * size);
    Some(changes.then_some(MomentumSlopes {
        parameter: index,
        value: guess,
        slopes,
    }))
}

/// The start with values of some parameters: that of the system in which all of them are put.
fn start_at(model: &Model, state: &BoundaryState, changed: &[(usize, f64)]) -> Option<Start> {
    let parameters = &model.analysis.parameters;
    let mut values: Vec<f64> = parameters.iter().map(|one| one.guess).collect();
    changed
        .iter()
        .for_each(|&(index, value)| values[index] = value);
    let model = with_values(model, &values).ok()?;
    resolve_start(&model, state).ok()
}
