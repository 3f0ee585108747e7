//! A solve whose goal is kept: where the motion leaves it under the last inputs, those that hold it are sought with the motion.

use std::borrow::Cow;
use std::ops::ControlFlow;
use std::time::Instant;

use crate::control::problem::{Control, Guess, SoughtHold};
use crate::control::{Earlier, hold_obstacle};
use crate::model::System;
use crate::tasks::grid::{Found, SolveRequest, find};
use crate::workflow::optimum::{Optimum, SolveLimits, seconds_left};
use crate::workflow::restarts::stopped;
use crate::workflow::{Iterate, WorkflowError, hold_check};

/// Notes that no inputs that hold a goal were found, and that there was no time for it.
pub(super) const NOT_FOUND: &str = "no inputs within the bounds were found that hold the goal";
pub(super) const UNFINISHED: &str = "the inputs that hold the goal were not found in the time: \"hold\": \"find\" seeks them at once";

/// An optimum, and the problem that it solves.
pub(super) struct HeldGoal<'a> {
    pub(super) found: Found,
    /// The problem, in which the inputs that hold the goal are unknowns where these were found.
    pub(super) control: Cow<'a, Control>,
    /// Note that none were found.
    pub(super) note: Option<String>,
}

/// Solves a problem, and again with the inputs that hold its goal as unknowns where it is left and can be held; that optimum counts if a
/// simulation stays at the goal.
///
/// # Errors
/// As of [`find`].
pub(super) fn solve_and_hold<'a>(
    system: &System,
    control: &'a Control,
    request: SolveRequest,
    observer: &mut dyn FnMut(usize, &Iterate<'_>) -> ControlFlow<()>,
) -> Result<HeldGoal<'a>, WorkflowError> {
    let began = Instant::now();
    let mut found = find(system, control, request, observer)?;
    found.optimum.hold(control);
    let seconds = seconds_left(request.limits.seconds, began);
    if !is_left(&found.optimum, control) {
        return Ok(HeldGoal {
            found,
            control: Cow::Borrowed(control),
            note: None,
        });
    }
    if stopped(seconds).is_some() {
        return Ok(unfinished(found, control));
    }
    let held = held(control, &found.optimum, true);
    let limits = SolveLimits {
        seconds,
        ..request.limits
    };
    let again = find(system, &held, SolveRequest { limits, ..request }, observer);
    let iterations = |again: &Found| found.iterations + again.iterations;
    match again {
        Ok(mut again) => {
            again.optimum.hold(&held);
            again.iterations = iterations(&again);
            if is_kept(&again.optimum, &held) {
                again.optimum.carried = found.optimum.carried;
                return Ok(HeldGoal {
                    found: again,
                    control: Cow::Owned(held),
                    note: None,
                });
            }
            found.iterations = again.iterations;
        }
        Err(error) => tracing::debug!(%error, "the inputs that hold the goal are not sought"),
    }
    if stopped(seconds_left(request.limits.seconds, began)).is_some() {
        return Ok(unfinished(found, control));
    }
    Ok(HeldGoal {
        found,
        control: Cow::Borrowed(control),
        note: Some(NOT_FOUND.to_owned()),
    })
}

/// The problem from an optimum of it, in which inputs that hold its goal are unknowns where they `are_sought`.
pub(super) fn held(control: &Control, optimum: &Optimum, are_sought: bool) -> Control {
    Control {
        sought_hold: match are_sought {
            true => SoughtHold::Always,
            false => control.sought_hold,
        },
        guess: Guess::Solution(Earlier::new(optimum.motion.clone())),
        ..control.clone()
    }
}

/// The first optimum, where the search for what holds its goal was stopped: by Ctrl-C the whole solve was.
fn unfinished(mut found: Found, control: &Control) -> HeldGoal<'_> {
    found.optimum.stopped = found.optimum.stopped.or(stopped(None));
    HeldGoal {
        found,
        control: Cow::Borrowed(control),
        note: Some(UNFINISHED.to_owned()),
    }
}

/// Returns true if an optimum leaves a goal for which inputs that hold it may be sought.
pub(super) fn is_left(optimum: &Optimum, control: &Control) -> bool {
    let afterwards = optimum.afterwards.as_ref();
    control.sought_hold == SoughtHold::WhereLeft
        && afterwards.is_some_and(|after| !after.is_held)
        && hold_obstacle(&optimum.model, control).is_none()
}

/// Returns true if an optimum is reproduced and its goal is kept.
pub(super) fn is_kept(optimum: &Optimum, control: &Control) -> bool {
    let tested = optimum.resimulation.as_ref();
    optimum.is_solved()
        && hold_check::warning(control, &optimum.model, &optimum.boundary, tested).is_none()
}
