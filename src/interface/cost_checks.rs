//! Checks of the costs of a control problem against its system.

use crate::control::problem::{CostFunction, EnergyCost, QuantityCost};
use crate::interface::error::{Result, require};
use crate::model::system::Joint;
use crate::model::{Quantity, System};

/// Refuses costs of parts that the system does not have, and weights and functions of time that are not finite.
pub(super) fn check_costs(costs: &[QuantityCost], system: &System) -> Result<()> {
    for cost in costs {
        let exists = match cost.quantity {
            Quantity::Joint { joint, .. } => {
                let joint = system.joints.get(joint);
                joint.is_some_and(Joint::has_coordinate)
            }
            Quantity::MarkerPlace { marker, axis } => marker < system.markers.len() && axis < 3,
            _ => true,
        };
        let CostFunction::Square { reference } = &cost.function;
        let is_sound = cost.weight > 0.0 && cost.weight.is_finite() && reference.is_sound();
        let found = || format!("{cost:?}");
        let expected =
            "a positive weight of a marker, or of a joint with one coordinate, along finite values";
        require(exists && is_sound, "cost", found, expected)?;
    }
    Ok(())
}

/// Refuses energies of parts that are no lumped muscles, and weights that are not positive.
pub(super) fn check_energies(costs: &[EnergyCost], system: &System) -> Result<()> {
    for cost in costs {
        let is_sound = cost.weight > 0.0 && cost.weight.is_finite();
        let found = || format!("{cost:?}");
        let expected = "a positive weight of a lumped muscle with a permittivity";
        require(cost.exists(system) && is_sound, "cost", found, expected)?;
    }
    Ok(())
}
