//! Limits of the rates of voltages that are given, over a given duration: data that no row of the program could change.

use crate::control::error::BoundaryError;
use crate::control::problem::{BoundaryState, Control, Duration, PathConstraint};
use crate::control::waypoint::instant_at;
use crate::math::{shortest, significant};
use crate::model::System;

/// Relative rounding of a rate.
const ROUNDING: f64 = 1e-8;

/// Refuses a given voltage that breaks a limit of its rate. `rest` are the inputs before the start and after the end, where these are known; the
/// steps from them and to them take half an interval.
pub(super) fn check(
    system: &System,
    control: &Control,
    rest: &[Option<Vec<f64>>; 2],
) -> Result<(), BoundaryError> {
    if !matches!(control.duration, Duration::Given(_)) {
        return Ok(());
    }
    let broken = |limit| broken(limit, (system, control), rest);
    match control.limits.iter().find_map(broken) {
        Some(reason) => Err(BoundaryError::Limit {
            place: "limits",
            reason,
        }),
        None => Ok(()),
    }
}

/// The message of a limit that a given voltage breaks.
fn broken(
    limit: &PathConstraint,
    (system, control): (&System, &Control),
    rest: &[Option<Vec<f64>>; 2],
) -> Option<String> {
    let (limit, part) = limit.with_part();
    let PathConstraint::VoltageRate { source, min, max } = *limit else {
        return None;
    };
    if !control.is_given(source) {
        return None;
    }
    let mut steps = steps(control, source, rest);
    if let Some(part) = part {
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
