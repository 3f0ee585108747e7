//! A solve whose goals are kept: where a motion leaves its goal under the last inputs, those that hold it are sought with the motion.

use std::borrow::Cow;
use std::ops::ControlFlow;
use std::time::Instant;

use crate::control::problem::{Control, ControlTask, Guess, SoughtHold};
use crate::control::{Earlier, hold_obstacle};
use crate::workflow::optimum::{Optimum, SolveLimits, seconds_left};
use crate::workflow::restarts::stopped;
use crate::workflow::{
    Iterate, SolveRequest, Together, WorkflowError, hold_check, optimise_together,
};

/// Notes that no inputs that hold a goal were found, and that there was no time for it.
const NOT_FOUND: &str = "no inputs within the bounds were found that hold the goal";
const UNFINISHED: &str = "the inputs that hold the goal were not found in the time: \"hold\": \"find\" seeks them at once";

/// Optima, and the problems that they solve.
pub(super) struct HeldGoals<'a> {
    pub(super) found: Together,
    /// The problems, in which the inputs that hold the goals are unknowns where these were found.
    pub(super) controls: Vec<Cow<'a, Control>>,
    /// For each a note that none were found.
    pub(super) notes: Vec<Option<String>>,
}

/// Solves a task, and again with the inputs that hold the goals as unknowns where these are left and can be held; those optima count if
/// simulations stay at the goals.
///
/// # Errors
/// As of [`optimise_together`].
pub(super) fn solve_and_hold<'a>(
    task: &ControlTask<'a>,
    request: SolveRequest,
    observer: &mut dyn FnMut(usize, &Iterate<'_>) -> ControlFlow<()>,
) -> Result<HeldGoals<'a>, WorkflowError> {
    let began = Instant::now();
    let mut found = optimise_together(task, request, observer)?;
    hold(&mut found, task);
    let each = task.motions.iter().zip(&found.optima);
    let left: Vec<bool> = each
        .map(|(motion, optimum)| is_left(optimum, motion.control))
        .collect();
    let end = |found: Together, note: Option<&str>| {
        let controls = task.motions.iter();
        let of = |is_left: &bool| note.filter(|_| *is_left).map(str::to_owned);
        Ok(HeldGoals {
            found,
            controls: controls.map(|one| Cow::Borrowed(one.control)).collect(),
            notes: left.iter().map(of).collect(),
        })
    };
    if !left.contains(&true) {
        return end(found, None);
    }
    let seconds = seconds_left(request.limits.seconds, began);
    if stopped(seconds).is_some() {
        unfinished(&mut found, &left);
        return end(found, Some(UNFINISHED));
    }
    let each = task.motions.iter().zip(&found.optima).zip(&left);
    let held: Vec<Control> = each
        .map(|((motion, optimum), is_left)| held(motion.control, optimum, *is_left))
        .collect();
    let limits = SolveLimits {
        seconds,
        ..request.limits
    };
    let again = task.with(&held);
    match optimise_together(&again, SolveRequest { limits, ..request }, observer) {
        Ok(mut second) => {
            hold(&mut second, &again);
            second.iterations += found.iterations;
            let mut each = held.iter().zip(&second.optima).zip(&left);
            if each.all(|((control, optimum), is_left)| {
                optimum.is_solved() && (!is_left || is_kept(optimum, control))
            }) {
                for (new, old) in second.optima.iter_mut().zip(&found.optima) {
                    new.carried = old.carried;
                }
                return Ok(HeldGoals {
                    found: second,
                    notes: vec![None; held.len()],
                    controls: held.into_iter().map(Cow::Owned).collect(),
                });
            }
            found.iterations = second.iterations;
        }
        Err(error) => tracing::debug!(%error, "the inputs that hold the goals are not sought"),
    }
    if stopped(seconds_left(request.limits.seconds, began)).is_some() {
        unfinished(&mut found, &left);
        return end(found, Some(UNFINISHED));
    }
    end(found, Some(NOT_FOUND))
}

/// Holds the voltages of the goals after the ends.
fn hold(found: &mut Together, task: &ControlTask<'_>) {
    let each = found.optima.iter_mut().zip(&task.motions);
    each.for_each(|(optimum, motion)| optimum.hold(motion.control));
}

/// The problem from an optimum of it, in which inputs that hold its goal are unknowns where they `are_sought`.
fn held(control: &Control, optimum: &Optimum, are_sought: bool) -> Control {
    Control {
        sought_hold: match are_sought {
            true => SoughtHold::Always,
            false => control.sought_hold,
        },
        guess: Guess::Solution(Earlier::new(optimum.motion.clone())),
        ..control.clone()
    }
}

/// Marks the optima whose search for what holds their goals was stopped: by Ctrl-C the whole solve was.
fn unfinished(found: &mut Together, left: &[bool]) {
    let each = found.optima.iter_mut().zip(left);
    for (optimum, _) in each.filter(|(_, is_left)| **is_left) {
        optimum.stopped = optimum.stopped.or(stopped(None));
    }
}

/// Returns true if an optimum leaves a goal for which inputs that hold it may be sought.
fn is_left(optimum: &Optimum, control: &Control) -> bool {
    let afterwards = optimum.afterwards.as_ref();
    control.sought_hold == SoughtHold::WhereLeft
        && afterwards.is_some_and(|after| !after.is_held)
        && hold_obstacle(&optimum.model, control).is_none()
}

/// Returns true if an optimum is reproduced and its goal is kept.
fn is_kept(optimum: &Optimum, control: &Control) -> bool {
    let tested = optimum.resimulation.as_ref();
    optimum.is_solved()
        && hold_check::warning(control, &optimum.model, &optimum.boundary, tested).is_none()
}
