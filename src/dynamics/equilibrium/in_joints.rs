//! Equilibrium in redundant coordinates by way of joint coordinates, where these exist.
//!
//! Both are the same states. In joint coordinates far ones are reached, as no update leaves the constraints; a state found there is one of
//! the redundant coordinates up to Newton's method from nearby, which finds the multipliers.

use crate::dynamics::equilibrium::result::Equilibrium;
use crate::dynamics::equilibrium::statics::{NewtonOutcome, Statics, UpdateRange};
use crate::dynamics::error::EquilibriumError;
use crate::model::{Analysis, Coordinates, Model};

/// The same system in joint coordinates; `None` where the coordinates are these already, where joints close loops, and where nodes are
/// unknowns, which are others in other coordinates.
pub(super) fn twin(model: &Model) -> Option<Model> {
    if model.coordinates == Coordinates::Reduced || !model.solids.is_empty() {
        return None;
    }
    let analysis = Analysis {
        coordinates: Some(Coordinates::Reduced),
        quantities: Vec::new(),
        curved: Default::default(),
        ..model.analysis.clone()
    };
    Model::for_analysis(model.system.clone(), analysis).ok()
}

/// Coordinates of one model at a configuration of the other.
pub(super) fn carried(from: &Model, z: &[f64], to: &Model) -> Vec<f64> {
    let instant = from.action.map.placed(z);
    let joints = from.joints(&instant, &vec![0.0; from.joint_readings.len()]);
    to.coordinates_of_poses(&from.poses(&instant), &joints)
}

/// A state of rest of the twin as one of the model; `None` where Newton's method does not confirm it.
///
/// # Errors
/// It was stopped.
pub(super) fn confirmed(
    statics: &mut Statics<'_>,
    twin: &Model,
    found: &Equilibrium,
    voltages: &[f64],
) -> Result<Option<Equilibrium>, EquilibriumError> {
    let z = carried(twin, &found.z, statics.model);
    let mut state = statics.state_without_field(&z);
    statics.weight = 1.0;
    match statics.newton(&mut state, voltages, UpdateRange::Near) {
        Ok(NewtonOutcome::Converged) => {
            let mut own = Equilibrium::new(statics, &state, voltages, found.route);
            own.iterations += found.iterations;
            Ok(Some(own))
        }
        Err(error @ EquilibriumError::Stopped(_)) => Err(error),
        Ok(NewtonOutcome::Failed) | Err(_) => Ok(None),
    }
}
