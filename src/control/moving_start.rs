//! Momenta of a start with given rates where masses are sought.
//!
//! The momentum p = M(q, π) q̇ of given coordinates and rates is a straight line in each mass, density or moment of inertia, and in
//! several of them together: its values at two values of a parameter tell its slope, and a third one that it is a straight line.

use crate::control::boundary_conditions::MomentumSlopes;
use crate::control::given_state::resolve_start;
use crate::control::problem::BoundaryState;
use crate::dynamics::Start;
use crate::functional::TermKind;
use crate::model::{Analysis, Model, Parameter, Presolved, Role, with_parameters};

/// Differences from a straight line this small, relative to the momenta, are rounding.
const STRAIGHT: f64 = 1e-9;

/// Gives a start with rates the momenta of its masses, and returns their derivatives by the parameters; none of a start at rest.
///
/// # Errors
/// The index of a parameter with which the start changes otherwise than along a straight line in its momenta.
pub fn momentum_slopes(
    model: &Model,
    (state, start): (&BoundaryState, &mut Start),
) -> Result<Vec<MomentumSlopes>, usize> {
    if start.momentum.iter().all(|p| *p == 0.0) || matches!(state, BoundaryState::EndOf(_)) {
        return Ok(Vec::new());
    }
    let terms = &model.action.intervals.terms;
    let kinetic = terms.iter().filter(|term| term.kind() == TermKind::Kinetic);
    let read: Vec<usize> = kinetic.flat_map(|term| term.not_by_squares()).collect();
    let scalars = model.variables.range(Role::Parameter).enumerate();
    let of_masses: Vec<usize> = scalars
        .filter(|(_, s)| read.contains(s))
        .map(|(index, _)| index)
        .collect();
    if let Some(&first) = of_masses.first() {
        let guess = model.analysis.parameters[first].guess;
        start.momentum = start_at(model, state, (first, guess))
            .ok_or(first)?
            .momentum;
    }
    let start = &*start;
    let slopes = of_masses.into_iter().filter_map(|index| {
        let found = by_parameter(model, (state, start), index);
        found.ok_or(index).transpose()
    });
    slopes.collect()
}

/// The same by one parameter, nothing where they do not change; other parameters keep their guesses. None where they are no straight line.
fn by_parameter(
    model: &Model,
    (state, start): (&BoundaryState, &Start),
    index: usize,
) -> Option<Option<MomentumSlopes>> {
    let parameters = &model.analysis.parameters;
    let Parameter {
        lower,
        upper,
        guess,
        ..
    } = parameters[index];
    // On the side of the bounds that leaves more room.
    let room = match upper - guess > guess - lower {
        true => (upper - guess).min(guess.abs().max(f64::MIN_POSITIVE)),
        false => -(guess - lower).min(guess.abs().max(f64::MIN_POSITIVE)),
    };
    let at = |part: f64| start_at(model, state, (index, guess + part * room));
    let (half, whole) = (at(0.5)?, at(1.0)?);
    let size = start
        .momentum
        .iter()
        .chain(&whole.momentum)
        .fold(0.0, |most: f64, p| most.max(p.abs()));
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

/// The start with a value of a parameter: that of the system in which all of them are put.
fn start_at(model: &Model, state: &BoundaryState, (index, value): (usize, f64)) -> Option<Start> {
    let parameters = &model.analysis.parameters;
    let mut values: Vec<f64> = parameters.iter().map(|one| one.guess).collect();
    values[index] = value;
    let system = with_parameters(&model.system, parameters, &values);
    // What may move is that of the model.
    let presolved = Presolved::new(&system, &model.analysis);
    let given = Analysis {
        parameters: Vec::new(),
        coordinates: Some(model.coordinates),
        ..model.analysis.clone()
    };
    let model = Model::of_presolved(system, given, presolved).ok()?;
    resolve_start(&model, state, "start").ok()
}
