//! Prescribed joint coordinates at start and goal: their values and rates there, and what contradicts them.
//!
//! Functions of time that a problem gives, where the duration may be an unknown.
//!
//! With a given duration their values are data. With a free one the times of instants and intervals follow from the interval length, and so
//! do the values; without jumps they have derivatives.
//!
//! Periodic motions: the start is sought, and the end has its coordinates and momenta.
//!
//! The last instant shares the coordinates of the first one, and their balances are one:
//!
//! ```text
//! D₂L_d(q_{N−1}, q_0) + D₁L_d(q_0, q_1) + f⁺ + f⁻ = 0.
//! ```

use crate::control::error::BoundaryError;
use crate::control::goal::instant_at;
use crate::control::numbering::Column;
use crate::control::problem::{BoundaryState, Control, Duration, Limit};
use crate::dynamics::{Start, rates_in_loops};
use crate::math::{Signal, shortest, significant};
use crate::model::{Model, Prescribed, System, Time, What, joint_unit};
use std::collections::BTreeMap;

/// Parts of a radian or of the length of the system by which a state may miss a prescribed value, and a periodic motion its start; of turns those
/// by which it may miss its period.
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
    what: &str,
) -> Result<Vec<f64>, BoundaryError> {
    let mut values = model.of_prescribed_joints(of);
    for (&joint, &found) in named {
        match model.prescribed.iter().find(|one| one.joint == joint) {
            Some(one) => check(model, one, [found, values[joint]], "start", what)?,
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
    place: &'static str,
    what: &str,
) -> Result<(), BoundaryError> {
    let unit = joint_unit(&model.system, one.joint);
    let size = if unit == "mm" { model.length() } else { 1.0 };
    if (found - value).abs() <= SAME * size {
        return Ok(());
    }
    let [found, value] = [found, value].map(|number| significant(number, 4));
    let name = &model.system.joints[one.joint].name;
    Err(BoundaryError::refused(
        place,
        format!(
            "the {what} of joint \"{name}\" is prescribed, {value} {unit} there; found {found} {unit}"
        ),
    ))
}

/// A start at coordinates of rest; nodes and prescribed joints may have velocities of their own.
///
/// # Errors
/// The rates of prescribed joints open a loop.
pub(super) fn at_rest(model: &Model, z: Vec<f64>) -> Result<Start, BoundaryError> {
    let rates = model.rates_at_rest(0.0, &model.action.map.placed(&z));
    let carried = rates.map(|rates| match model.has_loops() {
        true => model.node_rates().unwrap_or_else(|| vec![0.0; rates.len()]),
        false => rates,
    });
    match carried {
        Some(rates) => in_loops(model, z, rates, BTreeMap::new(), &[]),
        None => Ok(Start::at_rest(model, z)),
    }
}

/// A start at coordinates with rates; in closed loops these are of nodes and named bodies, and the others follow from them and from those of joints that
/// are named or prescribed.
///
/// # Errors
/// The rates open a loop.
pub(super) fn in_loops(
    model: &Model,
    z: Vec<f64>,
    rates: Vec<f64>,
    named: BTreeMap<usize, f64>,
    bodies: &[usize],
) -> Result<Start, BoundaryError> {
    let moving = model.moving_joints();
    let mut joints = named;
    let prescribed = model.prescribed.iter();
    joints.extend(prescribed.map(|one| (one.joint, one.motion.derivatives(0.0)[1])));
    let joints = joints.into_iter();
    let joints: Vec<(usize, f64)> = joints.filter(|(j, _)| moving.contains(j)).collect();
    let rates = rates_in_loops(model, &z, rates, &joints, bodies).map_err(|constraint| {
        let reason = format!(
            "the rates of joints and bodies open a closed loop, by {constraint}; leave out those that follow from the others, or name them all"
        );
        BoundaryError::refused("start", reason)
    })?;
    Ok(Start::with_rates(model, z, &rates))
}

/// Checks that the end of another motion has the prescribed values of a start.
pub(super) fn check_end(model: &Model, z: &[f64]) -> Result<(), BoundaryError> {
    let checked = |one: &Prescribed| {
        let values = [z[one.coordinate], one.motion.at(0.0)];
        check(model, one, values, "start", "coordinate")
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
        let reason = format!("joint \"{name}\" has a prescribed motion, {reason}");
        Err(BoundaryError::refused("goal", reason))
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
            check(model, one, [found, value], "goal", "coordinate")?;
        }
        given[one.coordinate] = Some(value);
    }
    Ok(())
}

/// Relative rounding of a rate.
const ROUNDING: f64 = 1e-8;

/// Refuses a given voltage that breaks a limit of its rate. `rest` are the inputs before the start and after the end, where these are known; the
/// steps from them and to them take half an interval.
pub(super) fn check_given_rates(
    system: &System,
    control: &Control,
    rest: &[Option<Vec<f64>>; 2],
) -> Result<(), BoundaryError> {
    if !matches!(control.duration, Duration::Given(_)) {
        return Ok(());
    }
    let broken = |limit| broken(limit, system, control, rest);
    match control.limits.iter().find_map(broken) {
        Some(reason) => Err(BoundaryError::refused("limits", reason)),
        None => Ok(()),
    }
}

/// The message of a limit that a given voltage breaks.
fn broken(
    limit: &Limit,
    system: &System,
    control: &Control,
    rest: &[Option<Vec<f64>>; 2],
) -> Option<String> {
    let What::Voltage(source) = limit.what else {
        return None;
    };
    let [min, max] = limit.bounds();
    if !control.is_given(source) {
        return None;
    }
    let mut steps = steps(control, source, rest);
    if let Some(part) = limit.part {
        let time = instant_at(part, control.intervals) as f64 * 2.0 * control.middle(0);
        let apart = |step: &(f64, f64)| (step.0 - time).abs();
        steps.sort_by(|a, b| apart(a).total_cmp(&apart(b)));
        steps.truncate(1);
    }
    let is_out = |rate: f64| {
        let rounding = ROUNDING * rate.abs();
        rate < min - rounding || rate > max + rounding
    };
    let (time, rate) = steps.into_iter().find(|(_, rate)| is_out(*rate))?;
    let (side, bound) = match rate < min {
        true => ("at least", min),
        false => ("at most", max),
    };
    let source = &system.sources()[source];
    let [rate, bound] = [rate, bound].map(|rate| significant(rate * 1e3, 5));
    let (name, unit, time) = (&source.name, source.kind.unit(), shortest(time, 6));
    Some(format!(
        "the rate of the given voltage of {name} is {rate} {unit}/s at {time} ms, \
         and its limit is {side} {bound} {unit}/s"
    ))
}

/// Times in ms and rates of the steps of a given voltage between the middles of intervals, and from rest and to it.
fn steps(control: &Control, source: usize, rest: &[Option<Vec<f64>>; 2]) -> Vec<(f64, f64)> {
    let last = control.intervals - 1;
    let at = |k: usize| control.given_voltage(source, control.middle(k));
    let voltages: Vec<f64> = (0..=last).filter_map(at).collect();
    let h = 2.0 * control.middle(0);
    let end = h * control.intervals as f64;
    let [before, after] = rest
        .each_ref()
        .map(|row| row.as_ref().map(|row| row[source]));
    let (first_one, last_one) = (voltages[0], voltages[last]);
    let mut steps = Vec::new();
    if control.goal == BoundaryState::Periodic {
        steps.push((0.0, (first_one - last_one) / h));
    }
    steps.extend(before.map(|before| (0.0, 2.0 * (first_one - before) / h)));
    let within = voltages.windows(2).zip(1..);
    steps.extend(within.map(|(pair, k)| (f64::from(k) * h, (pair[1] - pair[0]) / h)));
    steps.extend(after.map(|after| (end, 2.0 * (after - last_one) / h)));
    steps
}

impl Duration {
    /// Time in ms of a jump of a function of time, where it is after the start and before the longest of several durations.
    pub fn jump(self, function: &Signal) -> Option<f64> {
        match self {
            Self::Given(_) => None,
            Self::Free { max, .. } => function.jump().filter(|&time| 0.0 < time && time < max),
        }
    }

    /// Value of a function of time at the end; `None` where it differs from duration to duration.
    pub fn final_value(self, function: &Signal) -> Option<f64> {
        match self {
            Self::Given(end) => Some(function.at(end)),
            Self::Free { min, max, .. } => function.constant_within([min, max]),
        }
    }
}

impl Control {
    /// The function of time that gives the input of a source, where one that is not constant does.
    pub fn function(&self, source: usize) -> Option<&Signal> {
        let of_course = || {
            let course = self.course.as_ref().filter(|_| self.is_given(source))?;
            let smooth = course.table.is_none().then_some(&course.signals);
            smooth?.get(source)
        };
        let function = self.given.get(&source).or_else(of_course);
        function.filter(|function| !function.is_constant())
    }

    /// Returns true if an input is a function of a time that is an unknown.
    pub fn follows_time(&self, source: usize) -> bool {
        matches!(self.duration, Duration::Free { .. }) && self.function(source).is_some()
    }

    /// The function of time that the variable of a column follows, where the time is an unknown.
    pub(in crate::control) fn followed<'a>(
        &'a self,
        model: &'a Model,
        column: Column,
    ) -> Option<&'a Signal> {
        let Duration::Free { .. } = self.duration else {
            return None;
        };
        match column {
            Column::Instant { i, .. } => {
                let mut motions = model.prescribed.iter();
                let one = motions.find(|one| one.coordinate == i)?;
                Some(&one.motion).filter(|motion| !motion.is_constant())
            }
            Column::Interval { s, .. } => {
                self.function(model.variables.of(Time::Interval)[s].source?)
            }
            Column::Parameter { .. } | Column::Horizon => None,
        }
    }
}

/// Refuses what has no meaning of a motion without a start, or does not repeat.
pub(super) fn check_periodic(model: &Model, control: &Control) -> Result<(), BoundaryError> {
    if control.goal != BoundaryState::Periodic {
        return Ok(());
    }
    let refused = |reason: &str| Err(BoundaryError::refused("goal", reason));
    if !control.objective.energies.is_empty() {
        return refused(
            "energies of sources are no costs of a periodic motion; take \"effort\" or \"rate\"",
        );
    }
    if control.intervals < 2 {
        return refused("a periodic motion needs at least two intervals");
    }
    // What is read in the middle of intervals alone may alternate from instant to instant in a ring of an even number of them.
    if model.memory().next().is_some() {
        return refused(
            "periodic motions are those of muscles and blocks that do not creep and have no circuit, and of contacts that do not stick",
        );
    }
    for (source, named) in model.sources.iter().enumerate() {
        let function = control.function(source);
        if function.is_some_and(|function| !repeats(function, control.duration)) {
            return refused(&format!(
                "the given input of {} is a function of time that does not repeat after the duration of a periodic motion",
                named.name
            ));
        }
    }
    for one in &model.prescribed {
        let Duration::Given(end) = control.duration else {
            continue;
        };
        let size = match joint_unit(&model.system, one.joint) {
            "mm" => model.length(),
            _ => 1.0,
        };
        let [first, last] = [0.0, end].map(|time| one.motion.derivatives(time));
        let pairs = first.iter().zip(last).zip([1.0, end]);
        let changes = pairs.map(|((a, b), per)| (a - b).abs() * per);
        if changes.fold(0.0, f64::max) > SAME * size {
            let name = &model.system.joints[one.joint].name;
            return refused(&format!(
                "joint \"{name}\" has a prescribed motion that does not come back after the duration of a periodic motion"
            ));
        }
    }
    Ok(())
}

/// Returns true if a function of time has the period of a motion.
fn repeats(function: &Signal, duration: Duration) -> bool {
    match (function, duration) {
        (Signal::Sine { frequency, .. }, Duration::Given(end)) => {
            let turns = frequency * end;
            (turns - turns.round()).abs() < SAME * turns.abs().max(1.0)
        }
        _ => function.constant_within([0.0, f64::INFINITY]).is_some(),
    }
}
