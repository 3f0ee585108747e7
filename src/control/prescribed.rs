//! Prescribed joint coordinates at start and goal: their values and rates there, and what contradicts them.

use crate::control::error::BoundaryError;
use crate::control::problem::{Control, Duration};
use crate::dynamics::{Start, rates_in_loops};
use crate::math::significant;
use crate::model::{Model, Prescribed, joint_unit};
use std::collections::BTreeMap;

/// Parts of a radian or of the length of the system by which a state may miss a prescribed value.
const SAME: f64 = 1e-9;
/// Rates below this, in rad/ms or mm/ms, are rest.
const REST: f64 = 1e-12;

/// Values by joint of the scene, those that are named and those that are prescribed by `of`; others are zero.
///
/// # Errors
/// A prescribed joint is named with another value.
pub(super) fn by_joint(
    model: &Model,
    named: &BTreeMap<usize, f64>,
    of: impl Fn(&Prescribed) -> f64,
    (place, what): (&'static str, &str),
) -> Result<Vec<f64>, BoundaryError> {
    let mut values = model.of_prescribed_joints(of);
    for (&joint, &found) in named {
        match model.prescribed.iter().find(|one| one.joint == joint) {
            Some(one) => check(model, one, [found, values[joint]], (place, what))?,
            None => values[joint] = found,
        }
    }
    Ok(values)
}

/// Checks that a value of a prescribed coordinate is what is prescribed.
fn check(
    model: &Model,
    one: &Prescribed,
    [found, value]: [f64; 2],
    (place, what): (&'static str, &str),
) -> Result<(), BoundaryError> {
    let unit = joint_unit(&model.system, one.joint);
    let size = if unit == "mm" { model.length() } else { 1.0 };
    if (found - value).abs() <= SAME * size {
        return Ok(());
    }
    let [found, value] = [found, value].map(|number| significant(number, 4));
    Err(BoundaryError::Prescribed {
        place,
        reason: format!(
            "the {what} of joint \"{}\" is prescribed, {value} {unit} there; found {found} {unit}",
            model.system.joints[one.joint].name
        ),
    })
}

/// A start at coordinates of rest; nodes and prescribed joints may have velocities of their own.
///
/// # Errors
/// The rates of prescribed joints open a loop.
pub(super) fn at_rest(
    model: &Model,
    z: Vec<f64>,
    place: &'static str,
) -> Result<Start, BoundaryError> {
    match model.rates_at_rest(0.0, &model.action.map.placed(&z)) {
        Some(rates) => in_loops((model, place), z, rates, (BTreeMap::new(), &[])),
        None => Ok(Start::at_rest(model, z)),
    }
}

/// A start at coordinates with the rates of joints that are named or prescribed and of bodies that are named; those of closed loops follow from
/// them.
///
/// # Errors
/// The rates open a loop.
pub(super) fn in_loops(
    (model, place): (&Model, &'static str),
    z: Vec<f64>,
    rates: Vec<f64>,
    (named, bodies): (BTreeMap<usize, f64>, &[usize]),
) -> Result<Start, BoundaryError> {
    let moving = model.moving_joints();
    let mut joints = named;
    let prescribed = model.prescribed.iter();
    joints.extend(prescribed.map(|one| (one.joint, one.motion.derivatives(0.0)[1])));
    let joints = joints.into_iter();
    let joints: Vec<(usize, f64)> = joints.filter(|(j, _)| moving.contains(j)).collect();
    let rates = rates_in_loops(model, &z, rates, (&joints, bodies))
        .map_err(|constraint| BoundaryError::OpenRates { place, constraint })?;
    Ok(Start::with_rates(model, z, &rates))
}

/// Checks that the end of another motion has the prescribed values of a start.
pub(super) fn check_end(
    model: &Model,
    z: &[f64],
    place: &'static str,
) -> Result<(), BoundaryError> {
    let checked = |one: &Prescribed| {
        let values = [z[one.coordinate], one.motion.at(0.0)];
        check(model, one, values, (place, "coordinate"))
    };
    model.prescribed.iter().try_for_each(checked)
}

/// Gives the prescribed coordinates at the end of a motion.
///
/// # Errors
/// The goal names another value, or is at rest while a joint moves on, or the duration is free.
pub(super) fn at_goal(
    model: &Model,
    control: &Control,
    (given, rests): (&mut [Option<f64>], bool),
) -> Result<(), BoundaryError> {
    let refused = |one: &Prescribed, reason: &str| {
        let name = &model.system.joints[one.joint].name;
        Err(BoundaryError::Prescribed {
            place: "goal",
            reason: format!("joint \"{name}\" has a prescribed motion, {reason}"),
        })
    };
    for one in &model.prescribed {
        let Duration::Given(end) = control.duration else {
            return refused(one, "which needs a duration that is given");
        };
        let value = one.motion.at(end);
        if let Some(found) = given[one.coordinate] {
            check(model, one, [found, value], ("goal", "coordinate"))?;
        }
        let [_, rate, _] = one.motion.derivatives(end);
        if rests && rate.abs() > REST {
            return refused(one, "which goes on where the goal is at rest");
        }
        given[one.coordinate] = Some(value);
    }
    Ok(())
}
