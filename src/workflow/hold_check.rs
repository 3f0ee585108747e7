//! Check that the end of a motion can be kept: before the solve by known values, and after it by a simulation.

use crate::control::BoundaryConditions;
use crate::control::problem::{BoundaryState, Control, Hold};
use crate::model::Model;
use crate::workflow::error::WorkflowError;
use crate::workflow::resimulate::Resimulation;

/// Refuses an end that has to be held and is known not to be: its voltages are not known, or beyond their bounds, or the
/// goal is unstable under them.
///
/// # Errors
/// Place and reason.
pub(crate) fn check(
    control: &Control,
    model: &Model,
    boundary: &BoundaryConditions,
) -> Result<(), WorkflowError> {
    if control.hold == Hold::Reported || control.seeks_hold() {
        return Ok(());
    }
    let refused = |key: &str, reason: String| {
        Err(WorkflowError::Problem {
            place: format!("control.{key}"),
            reason,
        })
    };
    if boundary.rest[1].is_none() {
        let reason = "the final state must be held, but the goal names no voltages that hold it: take \"rest_at_voltages\", \
                      \"markers\" with \"hold\", or either of \"markers\" and \"joint_angles\" with \"hold\": \"find\"";
        return refused("goal", reason.to_owned());
    }
    if let Some((name, reason)) = beyond_bounds(control, model) {
        return refused(&format!("goal.hold.{name}"), reason);
    }
    match unstable(boundary) {
        Some(reason) => refused(
            "goal",
            format!("the final state must be held, but {reason}"),
        ),
        None => Ok(()),
    }
}

/// Returns the reason why the end of an optimum is not kept, in a line; nothing where it is, or where no voltages are known to keep it.
pub(crate) fn warning(
    control: &Control,
    model: &Model,
    boundary: &BoundaryConditions,
    resimulation: Option<&Resimulation>,
) -> Option<String> {
    let beyond = beyond_bounds(control, model).map(|(name, reason)| format!("{name}: {reason}"));
    let mut reasons: Vec<String> = beyond.into_iter().chain(unstable(boundary)).collect();
    if let Some(tested) = resimulation
        && let (Some(held), Some(drift)) = (tested.held, tested.drift)
        && !tested.is_held(model)
    {
        reasons.push(match &tested.failure {
            Some(failure) => format!("under the held inputs the motion ends early: {failure}"),
            None => format!("under the held inputs it moves by {drift} in {held} s"),
        });
    }
    (!reasons.is_empty()).then(|| format!("the goal cannot be kept: {}", reasons.join("; ")))
}

/// Note that the continuation of a motion with a free end is not known.
pub(crate) fn free_end(control: &Control) -> Option<String> {
    (control.goal == BoundaryState::Free).then(|| {
        "the end is free: the motion need not come to rest there, and what follows it is not verified".to_owned()
    })
}

/// The first source that is sought and held at a voltage that it may not have, and why not.
fn beyond_bounds(control: &Control, model: &Model) -> Option<(String, String)> {
    let BoundaryState::Markers {
        hold: Some(hold), ..
    } = &control.goal
    else {
        return None;
    };
    let [lower, upper] = control.voltage_bounds;
    let mut held = model.sources.iter().zip(hold).enumerate();
    held.find_map(|(s, (source, &voltage))| {
        let is_beyond = voltage < lower || voltage > upper;
        let is_sought = source.takes_voltage && !control.is_given(s);
        (is_beyond && is_sought).then(|| {
            let reason =
                format!("a hold of {voltage} V is beyond the bounds {lower} V to {upper} V");
            (source.name.clone(), reason)
        })
    })
}

/// That the goal is an unstable equilibrium, where it is.
fn unstable(boundary: &BoundaryConditions) -> Option<String> {
    let rest = boundary.goal.rest.as_ref()?;
    if rest.is_stable() != Some(false) {
        return None;
    }
    let softest = rest.stiffness.first().map_or(String::new(), |value| {
        format!(", the stiffness of its softest mode is {value:.3e} N mm/rad")
    });
    // An indifferent equilibrium, as of a cart that nothing holds, is kept where it is.
    let count = match rest.stiffness.is_empty() {
        true => rest.unstable.unwrap_or(1),
        false => rest.stiffness.iter().filter(|value| **value < 0.0).count(),
    };
    if count == 0 {
        return None;
    }
    let noun = if count == 1 {
        "direction"
    } else {
        "directions"
    };
    Some(format!(
        "it is an unstable equilibrium, in {count} {noun}{softest}"
    ))
}
