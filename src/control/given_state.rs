//! States that a problem gives: coordinates and momenta of a start, and checks of coordinates.

use crate::control::boundary_conditions::rest_at;
use crate::control::error::BoundaryError;
use crate::control::prescribed::{self, at_rest};
use crate::control::problem::BoundaryState;
use crate::dynamics::{Start, muscle_without_length, part_beyond_law};
use crate::functional::Order;
use crate::model::{Model, Prescribed, Role};

/// Coordinates and momenta of a start.
///
/// # Errors
/// There is no equilibrium, or joint coordinates do not fit the loops of the scene.
pub fn resolve_start(
    model: &Model,
    state: &BoundaryState,
    place: &'static str,
) -> Result<Start, BoundaryError> {
    match state {
        BoundaryState::RestAtVoltages(voltages, _) => {
            at_rest(model, rest_at(model, voltages, (place, 0.0))?.z, place)
        }
        BoundaryState::JointAngles {
            angles,
            rates: named_rates,
            velocities,
        } => {
            let value = |one: &Prescribed| one.motion.at(0.0);
            let joints = prescribed::by_joint(model, angles, value, (place, "coordinate"))?;
            let z = model.coordinates_at(&joints);
            check_constraints(model, &z, place)?;
            check_muscles(model, &z, place)?;
            let rate = |one: &Prescribed| one.motion.derivatives(0.0)[1];
            let of_joints = prescribed::by_joint(model, named_rates, rate, (place, "rate"))?;
            // In closed loops joints move with the rest.
            let of_joints = match model.has_loops() {
                true => vec![0.0; of_joints.len()],
                false => of_joints,
            };
            let rates = model.rates_at(&joints, &of_joints, velocities);
            let rates = rates.map_err(|body| BoundaryError::Follows {
                place,
                body: model.system.bodies[body].name.clone(),
            })?;
            let rates = model.rates_of_all(&rates, &of_joints);
            let bodies: Vec<usize> = velocities.keys().copied().collect();
            prescribed::in_loops(model, place, z, rates, named_rates.clone(), &bodies)
        }
        BoundaryState::EndOf(end) => {
            let start = end
                .start(model)
                .map_err(|reason| BoundaryError::OtherEnd { place, reason })?;
            check_muscles(model, &start.z, place)?;
            prescribed::check_end(model, &start.z, place)?;
            Ok(start)
        }
        BoundaryState::Markers { .. } | BoundaryState::Free | BoundaryState::Periodic => {
            Err(BoundaryError::NoStart { place })
        }
    }
}

/// Checks that no muscle has lost its length or its energy at coordinates.
pub(super) fn check_muscles(
    model: &Model,
    z: &[f64],
    place: &'static str,
) -> Result<(), BoundaryError> {
    if let Some(part) = part_beyond_law(model, z) {
        return Err(BoundaryError::BeyondLaw { place, part });
    }
    match muscle_without_length(model, z) {
        None => Ok(()),
        Some(muscle) => Err(BoundaryError::NoLength {
            place,
            muscle: model.system.muscles[muscle].name.clone(),
        }),
    }
}

/// Checks the constraints that the coordinates leave open.
fn check_constraints(model: &Model, z: &[f64], place: &'static str) -> Result<(), BoundaryError> {
    let mut instant = model.action.map.instant();
    let mut scratch = model.action.scratch(Order::Gradient);
    instant.z.copy_from_slice(z);
    model.action.map.place(&mut instant);
    model
        .action
        .evaluate_instant(Order::Gradient, &mut instant, &[], &mut scratch);
    let rows = &scratch.instant.plain.rows;
    let worst = (0..rows.len()).max_by(|&a, &b| rows[a].abs().total_cmp(&rows[b].abs()));
    let Some(worst) = worst else { return Ok(()) };
    let value = rows[worst].abs() / model.multiplier_time;
    if value > 1e-9 * model.length() {
        return Err(BoundaryError::Inconsistent {
            place,
            name: model.variables.with(Role::Multiplier)[worst].name.clone(),
            value,
        });
    }
    Ok(())
}
