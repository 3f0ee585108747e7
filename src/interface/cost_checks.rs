//! Checks of the costs, limits and waypoints of a control problem against its system.

use crate::control::problem::{CostFunction, During, EnergyCost, Limit, QuantityCost, Waypoint};
use crate::interface::error::{Entry, Result};
use crate::math::refuse;
use crate::model::system::{Joint, Muscle};
use crate::model::{System, What};

/// Refuses costs of parts that the system does not have, and weights and functions of time that are not finite.
pub(super) fn check_costs(
    costs: &[QuantityCost],
    is_periodic: bool,
    system: &System,
) -> Result<()> {
    for cost in costs {
        let quantity = &cost.quantity;
        let is_behind = |source: usize| {
            let muscle = system.muscles.get(source);
            muscle.is_some_and(Muscle::is_behind_resistor)
        };
        // An impulse is bounded, not squared.
        let is_rate = !quantity.is_step() || quantity.rate_factor(system).is_some();
        let is_single = quantity.before().is_none() && quantity.source().is_none_or(is_behind);
        let exists = quantity.what.exists(system) && is_single && is_rate;
        let is_followed = match &cost.function {
            CostFunction::Square { reference } => reference.is_sound(),
            CostFunction::Itself => true,
        };
        let is_timed = match cost.during {
            During::At(part) => is_on_the_way(part, is_periodic),
            During::Motion | During::End => true,
        };
        let is_sound = cost.weight > 0.0 && cost.weight.is_finite() && is_followed && is_timed;
        refuse!(unless exists && is_sound, Entry("cost");
            found format!("{cost:?}"),
            expected "a positive weight of a marker, of a joint with one coordinate, or of a quantity of a lumped muscle (of its source behind a resistor), along finite values or at a part of the duration above 0 and below 1");
    }
    Ok(())
}

/// Refuses energies of parts that are no lumped muscles, and weights that are not positive.
pub(super) fn check_energies(costs: &[EnergyCost], system: &System) -> Result<()> {
    for cost in costs {
        let is_sound = cost.weight > 0.0 && cost.weight.is_finite();
        refuse!(unless cost.exists(system) && is_sound, Entry("cost");
            found format!("{cost:?}"), expected "a positive weight of a lumped muscle with a permittivity");
    }
    Ok(())
}

/// Refuses limits of parts that the system does not have, and those that leave nothing.
pub(super) fn check_limits(limits: &[Limit], system: &System) -> Result<()> {
    for limit in limits {
        let is_then = limit.part.is_none_or(|part| part > 0.0 && part <= 1.0);
        let has_field = !matches!(limit.what, What::Field(_)) || limit.max > 0.0;
        let leaves = limit.min <= limit.max && has_field;
        refuse!(unless limit.what.exists(system) && leaves && is_then, Entry("limit");
            found format!("{limit:?}"), expected "a range of a part of the system");
    }
    Ok(())
}

/// Refuses waypoints of parts that the system does not have, and those that are not on the way.
pub(super) fn check_waypoints(
    waypoints: &[Waypoint],
    is_periodic: bool,
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
        refuse!(unless holds, Entry("waypoint");
            found format!("{waypoint:?}"),
            expected "a finite place of a marker or joint at a part of the duration above 0 and below 1");
    }
    Ok(())
}

/// Returns true if a part of the duration lies on the way: the end of a periodic motion does.
fn is_on_the_way(part: f64, is_periodic: bool) -> bool {
    part > 0.0 && (part < 1.0 || (is_periodic && part == 1.0))
}
