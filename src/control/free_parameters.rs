//! Free parameters where they may not act, and states of rest that depend on one.

use crate::control::boundary_conditions::{
    BoundaryConditions, MomentumSlopes, Rests, momentum_slopes, of_masses, rest_with,
};
use crate::control::error::BoundaryError;
use crate::control::limits::{BoundedQuantity, Limits, When};
use crate::control::problem::{BoundaryState, Control};
use crate::dynamics::Start;
use crate::model::{
    At, Constant, Coordinates, MaterialConstant, Model, NotSought, Parameter, PartKind, Quantity,
    Role, System, What, check_parameters, with_parameters,
};

/// A state of rest that moves by less, relative to the size of its coordinates, does not depend on a parameter.
const SAME: f64 = 1e-9;
/// Multiples of the guess at which states of rest are compared where a bound is infinite.
const PROBES: [f64; 2] = [0.5, 2.0];

/// The system with parameters at their guesses.
///
/// # Errors
/// A parameter cannot be sought.
pub(super) fn at_guess(system: &System, control: &Control) -> Result<System, BoundaryError> {
    let parameters = &control.parameters;
    check_parameters(system, parameters).map_err(|NotSought { parameter, reason }| {
        BoundaryError::parameter(&parameters[parameter], reason)
    })?;
    let guesses: Vec<f64> = parameters.iter().map(|p| p.guess).collect();
    Ok(with_parameters(system, parameters, &guesses))
}

/// Returns true if a quantity is a function of a parameter, but for laws of the intervals, which read it.
fn reads(quantity: &Quantity, parameter: &Parameter) -> bool {
    let follows = |muscle: usize, is_read: fn(Constant) -> bool| {
        let mut constants = parameter.constants.iter().map(|c| c.constant);
        constants.any(|c| c.muscle() == Some(muscle) && is_read(c))
    };
    let is_length = |c: Constant| matches!(c, Constant::End(..) | Constant::Prestretch(_));
    let is_of_instants = quantity.at == At::Instant;
    let is_of_marker = |&(kind, _): &(PartKind, usize)| kind == PartKind::Marker;
    match &quantity.what {
        &What::Stretch(muscle) if is_of_instants => follows(muscle, is_length),
        &(What::ChargedField(muscle) | What::Capacitance(muscle)) if is_of_instants => {
            follows(muscle, |c| {
                use MaterialConstant::{C1, C2, Permittivity};
                let is_electric = matches!(c, Constant::Material(_, C1 | C2 | Permittivity));
                c.is_shape() || is_electric || matches!(c, Constant::Layer(_))
            })
        }
        what if is_of_instants && what.parts().iter().any(is_of_marker) => {
            parameter.constants.iter().any(|c| c.constant.is_place())
        }
        What::Reaction { .. } | What::Charge(_) => true,
        _ => false,
    }
}

/// A quantity of the instants at the starts of the intervals, and at the end of the last one, where it reads a parameter: parameters belong to
/// intervals.
pub(crate) fn ends_that_read(
    quantity: &Quantity,
    parameters: &[Parameter],
) -> Option<[Quantity; 2]> {
    let mut parameters = parameters.iter();
    if !parameters.any(|parameter| reads(quantity, parameter)) {
        return None;
    }
    let [start, end] = [At::Start, At::End].map(|at| quantity.in_intervals(at));
    Some([start?, end?])
}

/// Puts limits of the instants that read a parameter in the place of the starts of intervals and the end of the last one: parameters belong to
/// intervals.
pub(super) fn in_intervals(limits: &mut Limits, control: &Control) {
    let list = std::mem::take(&mut limits.list);
    for bounded in list {
        match ends_that_read(&bounded.quantity, &control.parameters) {
            Some([start, end]) => {
                let is_closed = control.goal == BoundaryState::Periodic;
                let of_end = (!is_closed || bounded.when.is_single()).then_some(end);
                let (at_start, at_end) = match bounded.when {
                    When::Everywhere => (Some(start), When::At(1.0)),
                    single => (None, single),
                };
                limits.list.extend(at_start.map(|quantity| BoundedQuantity {
                    quantity,
                    ..bounded.clone()
                }));
                limits.list.extend(of_end.map(|quantity| BoundedQuantity {
                    quantity,
                    when: at_end,
                    ..bounded.clone()
                }));
            }
            None => limits.list.push(bounded),
        }
    }
}

/// Refuses parameters that nothing of the model reads, and limits and costs that depend on one. Returns true of the start, and of the goal,
/// where it is a state of rest that depends on one.
pub(super) fn check(
    model: &Model,
    control: &Control,
    boundary: &BoundaryConditions,
    rest: [Option<&[f64]>; 2],
) -> Result<[bool; 2], BoundaryError> {
    let layout = model.action.layout();
    let scalars = model.variables.range(Role::Parameter);
    for (s, parameter) in scalars.zip(&control.parameters) {
        let refused = |reason: &str| Err(BoundaryError::parameter(parameter, reason));
        let mut measures = model.action.intervals.measures.iter();
        let is_measured = measures.any(|measure| measure.scalars().contains(&s));
        if !is_measured && !layout.mixed.entries().any(|(_, read)| read == s) {
            return refused("nothing that moves reads it");
        }
        let mut constants = parameter.constants.iter();
        if model.coordinates == Coordinates::Redundant && constants.any(|c| c.constant.is_place()) {
            return refused(
                "a place of a body, joint or marker depends on it, which is offered in joint coordinates alone",
            );
        }
        let mut quantities = model.analysis.quantities.iter();
        if quantities.any(|quantity| reads(quantity, parameter)) {
            return refused(
                "the quantity of a limit or of the objective depends on it, which is not offered",
            );
        }
    }
    remembered_start(model, control)?;
    let ends = [
        ("start", 0.0, &control.start),
        ("goal", control.duration.first(), &control.goal),
    ];
    let mut depends = [false; 2];
    for ((depends, (place, time, state)), z) in depends.iter_mut().zip(ends).zip(rest) {
        let (BoundaryState::RestAtVoltages(voltages, _), Some(z)) = (state, z) else {
            continue;
        };
        for (index, parameter) in control.parameters.iter().enumerate() {
            if depends_on(model, place, time, voltages, z, index) {
                *depends = true;
                let reason = not_sought(model, boundary, place);
                if let Some(reason) = reason.or_else(|| steps_from_rest(boundary, place)) {
                    return Err(BoundaryError::parameter(parameter, reason));
                }
            }
        }
    }
    Ok(depends)
}

/// Refuses parameters that change what muscles remember at a start whose coordinates are given: the stretches there.
fn remembered_start(model: &Model, control: &Control) -> Result<(), BoundaryError> {
    if matches!(
        control.start,
        BoundaryState::RestAtVoltages(..) | BoundaryState::Free
    ) {
        return Ok(());
    }
    let muscles = &model.system.muscles;
    let remembers = |&m: &usize| !muscles[m].material.maxwell.list().is_empty();
    for parameter in &control.parameters {
        let mut stretched = parameter.constants.iter().filter_map(|c| match c.constant {
            Constant::End(m, ..) | Constant::Prestretch(m) => Some(m),
            _ => None,
        });
        if let Some(m) = stretched.find(remembers) {
            let reason = format!(
                "the state of the Maxwell branches of muscle \"{}\" at the start depends on it; give a start at rest (\"rest_at_voltages\")",
                muscles[m].name
            );
            return Err(BoundaryError::parameter(parameter, reason));
        }
    }
    Ok(())
}

/// Changes of the momenta at a start that moves with free parameters.
///
/// # Errors
/// They are no straight lines, or the start is the end of another motion, whose masses were others.
pub(super) fn moving_start(
    model: &Model,
    control: &Control,
    start: &mut Start,
) -> Result<Vec<MomentumSlopes>, BoundaryError> {
    if !control.knows_start() {
        return Ok(Vec::new());
    }
    let is_end = matches!(control.start, BoundaryState::EndOf(_));
    let moves = start.momentum.iter().any(|p| *p != 0.0);
    let found = match of_masses(model).first() {
        Some(&first) if is_end && moves => Err(first),
        _ => momentum_slopes(model, &control.start, start),
    };
    found.map_err(|index| {
        BoundaryError::parameter(
            &control.parameters[index],
            "a mass depends on it, and with it the momentum at the start, which is no straight line in it; give a start at rest",
        )
    })
}

/// A limit of steps from or to a state of rest that depends on a parameter: what is subtracted there would have to follow it.
fn steps_from_rest(boundary: &BoundaryConditions, place: &str) -> Option<String> {
    let mut limits = boundary.limits.list.iter();
    let reads = |quantity: &Quantity| {
        !matches!(quantity.what, What::Voltage(_)) && quantity.before().is_some()
    };
    let limit = limits.find(|one| reads(&one.quantity))?;
    Some(format!(
        "the state of rest at the {place} depends on it, and {} is counted from there, which is not offered",
        limit.name
    ))
}

/// The reason why a state of rest cannot be an unknown, if there is one.
fn not_sought(model: &Model, boundary: &BoundaryConditions, place: &str) -> Option<String> {
    let is_part = place == "goal" && boundary.goal.rests != Rests::Everything;
    let what = match () {
        () if !model.variables.range(Role::Multiplier).is_empty() => {
            "in joint coordinates, without constraints, alone"
        }
        () if !model.prescribed.is_empty() => "without prescribed motions of joints alone",
        () if is_part => "where everything rests alone",
        () => return None,
    };
    Some(format!(
        "the state of rest at the {place} depends on it, which is offered {what}; give its joint coordinates (\"joint_angles\")"
    ))
}

/// Returns true if a state of rest is another one, or none, where a parameter takes other values.
fn depends_on(
    model: &Model,
    place: &'static str,
    time: f64,
    voltages: &[f64],
    z: &[f64],
    index: usize,
) -> bool {
    let parameters = &model.analysis.parameters;
    let Parameter {
        lower,
        upper,
        guess,
        ..
    } = &parameters[index];
    let mut pairs = [lower, upper].into_iter().zip(PROBES);
    pairs.any(|(bound, probe)| {
        let value = if bound.is_finite() {
            *bound
        } else {
            probe * guess
        };
        let mut values: Vec<f64> = parameters.iter().map(|p| p.guess).collect();
        values[index] = value;
        let Ok(found) = rest_with(model, voltages, &values, place, time) else {
            return true;
        };
        let size = model.length();
        let sizes = model.sizes();
        let count = model.coordinate_count();
        let mut moved = z[..count].iter().zip(&found.z).zip(sizes);
        let is_same = |((a, b), s): ((&f64, &f64), f64)| (a - b).abs() <= SAME * s.min(size);
        !moved.all(is_same)
    })
}
