//! Prescribed joint coordinates at start and goal: their values and rates there, and what contradicts them.

use crate::control::error::BoundaryError;
use crate::control::problem::{BoundaryState, Control};
use crate::dynamics::{Start, rates_in_loops};
use crate::math::{shortest, significant};
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
    let rates = model.rates_at_rest(0.0, &model.action.map.placed(&z));
    let carried = rates.map(|rates| match model.has_loops() {
        true => model.node_rates().unwrap_or_else(|| vec![0.0; rates.len()]),
        false => rates,
    });
    match carried {
        Some(rates) => in_loops((model, place), z, rates, (BTreeMap::new(), &[])),
        None => Ok(Start::at_rest(model, z)),
    }
}

/// A start at coordinates with rates; in closed loops these are of nodes and named bodies, and the others follow from them and from those of joints that
/// are named or prescribed.
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

/// Refuses prescribed motions that go on where the goal is at rest, or do not fit a duration that is free.
pub(super) fn check_end_of_motions(
    model: &Model,
    control: &Control,
    rests: bool,
) -> Result<(), BoundaryError> {
    let refused = |one: &Prescribed, reason: &str| {
        let name = &model.system.joints[one.joint].name;
        Err(BoundaryError::Prescribed {
            place: "goal",
            reason: format!("joint \"{name}\" has a prescribed motion, {reason}"),
        })
    };
    let duration = control.duration;
    for one in &model.prescribed {
        if let Some(time) = duration.jump(&one.motion) {
            let time = shortest(time, 6);
            let reason = format!("which jumps at {time} ms and needs a duration that is given");
            return refused(one, &reason);
        }
        let is_open = duration.final_value(&one.motion).is_none();
        if is_open && control.goal == BoundaryState::Periodic {
            return refused(
                one,
                "with which a periodic one needs a duration that is given",
            );
        }
        let [_, rate, _] = one.motion.derivatives(duration.first());
        if rests && (is_open || rate.abs() > REST) {
            return refused(one, "which goes on where the goal is at rest");
        }
    }
    Ok(())
}

/// Gives the prescribed coordinates at the end of a motion, but those that depend on a duration that is free.
///
/// # Errors
/// The goal names another value.
pub(super) fn at_goal(
    model: &Model,
    control: &Control,
    given: &mut [Option<f64>],
) -> Result<(), BoundaryError> {
    for one in &model.prescribed {
        let Some(value) = control.duration.final_value(&one.motion) else {
            continue;
        };
        if let Some(found) = given[one.coordinate] {
            check(model, one, [found, value], ("goal", "coordinate"))?;
        }
        given[one.coordinate] = Some(value);
    }
    Ok(())
}
