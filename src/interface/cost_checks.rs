//! Checks of the costs, limits and waypoints of a control problem against its system.

use crate::control::problem::{
    CostFunction, During, EnergyCost, PathConstraint, QuantityCost, Waypoint,
};
use crate::interface::error::{Result, require};
use crate::model::system::{Fidelity, Joint, Muscle};
use crate::model::{Quantity, Reaction, System};

/// Refuses costs of parts that the system does not have, and weights and functions of time that are not finite.
pub(super) fn check_costs(
    (costs, is_periodic): (&[QuantityCost], bool),
    system: &System,
) -> Result<()> {
    for cost in costs {
        let exists = match cost.quantity {
            Quantity::Joint { joint, .. } | Quantity::JointStep { joint, .. } => {
                let joint = system.joints.get(joint);
                joint.is_some_and(Joint::has_coordinate)
            }
            Quantity::MarkerPlace { marker, axis, .. } => marker < system.markers.len() && axis < 3,
            Quantity::SquaredSpeed { marker, .. } => marker < system.markers.len(),
            Quantity::Tension { muscle, .. } => {
                let muscle = system.muscles.get(muscle);
                muscle.is_some_and(|m| m.fidelity == Fidelity::Lumped)
            }
            Quantity::SourceCurrent { muscle, .. } | Quantity::SourcePower { muscle, .. } => {
                let muscle = system.muscles.get(muscle);
                muscle.is_some_and(Muscle::is_behind_resistor)
            }
            Quantity::OfMuscles { ref muscles, .. } => are_lumped(muscles, system),
            ref quantity if quantity.before().is_some() => false,
            _ => true,
        };
        let is_followed = match &cost.function {
            CostFunction::Square { reference } => reference.is_sound(),
            CostFunction::Itself => true,
        };
        let is_timed = match cost.during {
            During::At(part) => is_on_the_way(part, is_periodic),
            During::Motion | During::End => true,
        };
        let is_sound = cost.weight > 0.0 && cost.weight.is_finite() && is_followed && is_timed;
        let found = || format!("{cost:?}");
        let expected = "a positive weight of a marker, of a joint with one coordinate, or of a quantity of a lumped muscle (of its source behind a resistor), along finite values or at a part of the duration above 0 and below 1";
        require(exists && is_sound, "cost", found, expected)?;
    }
    Ok(())
}

/// Returns true if these are lumped muscles, one or more.
fn are_lumped(muscles: &[usize], system: &System) -> bool {
    let is_lumped = |&m: &usize| {
        let muscle = system.muscles.get(m);
        muscle.is_some_and(|muscle| muscle.fidelity == Fidelity::Lumped)
    };
    !muscles.is_empty() && muscles.iter().all(is_lumped)
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

/// Refuses limits of parts that the system does not have, and those that leave nothing.
pub(super) fn check_limits(limits: &[PathConstraint], system: &System) -> Result<()> {
    for limit in limits {
        let holds = match *limit {
            PathConstraint::Once { part, ref limit } => {
                check_limits(std::slice::from_ref(limit), system)?;
                part > 0.0 && part <= 1.0
            }
            PathConstraint::Reaction {
                joint,
                of,
                along,
                min,
                max,
            } => {
                let is_unit = (along.norm() - 1.0).abs() < 1e-9;
                let joint = system.joints.get(joint);
                let is_known = |joint: &Joint| of == Reaction::Force || joint.has_torque();
                joint.is_some_and(is_known) && is_unit && min <= max
            }
            PathConstraint::MarkerSpeed { marker, min, max } => {
                marker < system.markers.len() && min <= max
            }
            PathConstraint::ElectricField { muscle, max } => {
                muscle < system.muscles.len() && max > 0.0
            }
            PathConstraint::VoltageRate { source, min, max } => {
                let sources = system.sources();
                sources.get(source).is_some_and(|s| s.takes_voltage) && min <= max
            }
            PathConstraint::Current { muscle, min, max }
            | PathConstraint::Power { muscle, min, max } => {
                let muscle = system.muscles.get(muscle);
                muscle.is_some_and(Muscle::has_measured_current) && min <= max
            }
            PathConstraint::Tension { muscle, min, max } => {
                let muscle = system.muscles.get(muscle);
                muscle.is_some_and(|m| m.fidelity == Fidelity::Lumped) && min <= max
            }
            PathConstraint::OfMuscles {
                ref muscles,
                min,
                max,
                ..
            } => are_lumped(muscles, system) && min <= max,
            PathConstraint::Stretch { muscle, min, max } => {
                muscle < system.muscles.len() && min <= max
            }
            PathConstraint::JointAngle { joint, min, max }
            | PathConstraint::JointRate { joint, min, max } => {
                let joint = system.joints.get(joint);
                joint.is_some_and(Joint::has_coordinate) && min <= max
            }
            PathConstraint::BlockField { .. }
            | PathConstraint::PeakVoltage { .. }
            | PathConstraint::Marker { .. } => true,
        };
        let found = || format!("{limit:?}");
        require(holds, "limit", found, "a range of a part of the system")?;
    }
    Ok(())
}

/// Refuses waypoints of parts that the system does not have, and those that are not on the way.
pub(super) fn check_waypoints(
    (waypoints, is_periodic): (&[Waypoint], bool),
    system: &System,
) -> Result<()> {
    for waypoint in waypoints {
        let of_joint = |(joint, value): (&usize, &f64)| {
            let joint = system.joints.get(*joint);
            joint.is_some_and(Joint::has_coordinate) && value.is_finite()
        };
        let mut given = waypoint.places.values().flat_map(|place| place.given());
        let holds = is_on_the_way(waypoint.part, is_periodic)
            && waypoint.places.keys().all(|&m| m < system.markers.len())
            && given.all(|(_, value)| value.is_finite())
            && waypoint.angles.iter().all(of_joint);
        let found = || format!("{waypoint:?}");
        let expected =
            "a finite place of a marker or joint at a part of the duration above 0 and below 1";
        require(holds, "waypoint", found, expected)?;
    }
    Ok(())
}

/// Returns true if a part of the duration lies on the way: the end of a periodic motion does.
fn is_on_the_way(part: f64, is_periodic: bool) -> bool {
    part > 0.0 && (part < 1.0 || (is_periodic && part == 1.0))
}
