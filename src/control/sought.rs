//! Sought parameters where they may not act: states of rest, and limits.

use crate::control::error::BoundaryError;
use crate::control::problem::{BoundaryState, Control};
use crate::control::rest::rest_with;
use crate::model::{
    Constant, FieldPlace, Model, NotSought, Parameter, Quantity, Role, System, check_parameters,
    with_parameters,
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
        BoundaryError::Parameter {
            name: parameters[parameter].name.clone(),
            reason,
        }
    })?;
    let guesses: Vec<f64> = parameters.iter().map(|p| p.guess).collect();
    Ok(with_parameters(system, parameters, &guesses))
}

/// Returns true if a quantity is a function of a parameter.
fn reads(quantity: &Quantity, parameter: &Parameter) -> bool {
    match *quantity {
        Quantity::SquaredStretch { muscle }
        | Quantity::ChargedField { muscle, .. }
        | Quantity::SourceCurrent { muscle, .. }
        | Quantity::SourcePower { muscle, .. } => parameter.moves(muscle),
        Quantity::SquaredField {
            place: FieldPlace::Muscle(muscle),
            ..
        } => {
            let mut constants = parameter.constants.iter();
            parameter.moves(muscle) || constants.any(|c| c.constant == Constant::Layer(muscle))
        }
        Quantity::Tension { muscle, .. } => {
            let mut constants = parameter.constants.iter();
            parameter.moves(muscle) || constants.any(|c| c.constant.muscle() == Some(muscle))
        }
        Quantity::Capacitance { muscle }
        | Quantity::ChargeStep { muscle, .. }
        | Quantity::EnergyStep { muscle, .. } => {
            let is_read = |constant: Constant| {
                let is_of_motion =
                    matches!(constant, Constant::ShearModulus(_) | Constant::Viscosity(_));
                constant.muscle() == Some(muscle) && !is_of_motion
            };
            parameter.moves(muscle) || parameter.constants.iter().any(|c| is_read(c.constant))
        }
        Quantity::ReactionStep { .. } => true,
        // Constants of finite elements are not sought.
        Quantity::SquaredField { .. } => false,
        // They read the parameter itself, which no constant follows.
        Quantity::PeakVoltage { .. } | Quantity::PeakExcess { .. } => false,
        Quantity::VoltageStep { .. } => false,
        Quantity::Joint { .. }
        | Quantity::JointStep { .. }
        | Quantity::MarkerPlace { .. }
        | Quantity::MarkerStep { .. }
        | Quantity::SquaredSpeed { .. }
        | Quantity::MarkerRegion { .. }
        | Quantity::Direction { .. } => false,
    }
}

/// Refuses parameters that nothing of the model reads, and states of rest, limits and costs that depend on one.
pub(super) fn check(
    model: &Model,
    control: &Control,
    rest: [Option<&[f64]>; 2],
) -> Result<(), BoundaryError> {
    let layout = model.action.layout();
    let scalars = model.variables.range(Role::Parameter);
    for (s, parameter) in scalars.zip(&control.parameters) {
        let mut measures = model.action.intervals.measures.iter();
        let is_measured = measures.any(|measure| measure.scalars().contains(&s));
        if !is_measured && !layout.mixed.entries().any(|(_, read)| read == s) {
            return Err(BoundaryError::Parameter {
                name: parameter.name.clone(),
                reason: "nothing that moves reads it".to_owned(),
            });
        }
        let mut quantities = model.analysis.quantities.iter();
        if quantities.any(|quantity| reads(quantity, parameter)) {
            return Err(BoundaryError::Parameter {
                name: parameter.name.clone(),
                reason:
                    "the quantity of a limit or of the objective depends on it, which is not offered"
                        .to_owned(),
            });
        }
    }
    let ends = [
        (("start", 0.0), &control.start),
        (("goal", control.duration.first()), &control.goal),
    ];
    for ((at, state), z) in ends.into_iter().zip(rest) {
        if let (BoundaryState::RestAtVoltages(voltages, _), Some(z)) = (state, z) {
            for index in 0..control.parameters.len() {
                check_rest(model, (at, voltages, z), index)?;
            }
        }
    }
    Ok(())
}

/// Refuses a state of rest that is another one where a parameter takes other values.
fn check_rest(
    model: &Model,
    (at, voltages, z): ((&'static str, f64), &[f64], &[f64]),
    index: usize,
) -> Result<(), BoundaryError> {
    let parameters = &model.analysis.parameters;
    let Parameter {
        name,
        lower,
        upper,
        guess,
        ..
    } = &parameters[index];
    let refused = |why: &str| BoundaryError::Parameter {
        name: name.clone(),
        reason: format!(
            "the state of rest at the {} {why}; give its joint coordinates (\"joint_angles\")",
            at.0
        ),
    };
    for (bound, probe) in [lower, upper].into_iter().zip(PROBES) {
        let value = if bound.is_finite() {
            *bound
        } else {
            probe * guess
        };
        let mut values: Vec<f64> = parameters.iter().map(|p| p.guess).collect();
        values[index] = value;
        let found = rest_with(model, voltages, &values, at)
            .map_err(|_| refused("does not exist for all values of it"))?;
        let size = model.length();
        let sizes = model.sizes();
        let count = model.coordinate_count();
        let mut moved = z[..count].iter().zip(&found.z).zip(sizes);
        let is_same = |((a, b), s): ((&f64, &f64), f64)| (a - b).abs() <= SAME * s.min(size);
        if !moved.all(is_same) {
            return Err(refused("depends on it"));
        }
    }
    Ok(())
}
