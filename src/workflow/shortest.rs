//! The shortest motion to a goal that takes no less time than is asked for, and one that is as slow as the slowest mode.

use std::ops::ControlFlow;

use crate::control::Solution;
use crate::control::problem::{Control, Duration, MotionTask, Objective, Voltages};
use crate::math::Signal;
use crate::model::{Model, Role};
use crate::nlp::Status;
use crate::workflow::coupled::put_after;
use crate::workflow::motion::Iterate;
use crate::workflow::optimum::{Optimum, Shortest};
use crate::workflow::restarts::{Further, ITERATIONS, displaced, is_infeasible};

/// Largest free duration and the first one, as multiples of the given one.
const LONGEST: f64 = 20.0;
const FIRST: f64 = 2.0;
/// Iterations of its solve, as a multiple of those of the first one, within these limits.
const TIMES: usize = 2;
const FEWEST: usize = 60;
const MOST: usize = 200;
/// A free duration that is longer by no more than this part lies on its lower bound.
const ON_BOUND: f64 = 1e-5;
/// Largest duration of a slow motion in halves of the period of the slowest mode.
const SLOWEST: f64 = 4.0;
/// Cost of inputs that cross their ranges evenly in half that period, as a part of the cost of this time: what is faster than the slowest mode
/// costs more than it saves, and the mode itself does not.
const SMOOTH: f64 = 0.5;

/// The problem whose duration is free and alone costs something.
fn freed(control: &Control, given: f64) -> Control {
    Control {
        duration: Duration::Free {
            min: given,
            max: LONGEST * given,
            guess: FIRST * given,
        },
        objective: Objective {
            duration: 1.0,
            ..Objective::default()
        },
        ..control.clone()
    }
}

/// Returns true if what the problem gives over time has derivatives by the duration, and its goal rests at all of them or at none.
fn fits(control: &Control) -> bool {
    let has_jump = |function: &Signal| control.duration.jump(function).is_some();
    let changes = |function: &Signal| control.duration.final_value(function).is_none();
    let rests = control.goal.voltages().is_some();
    let is_sampled = matches!(control.course, Some(Voltages::Sampled { .. }));
    let mut functions = control.given.values();
    !is_sampled && !functions.any(|function| has_jump(function) || (rests && changes(function)))
}

/// The same from half a period of the slowest mode on, with inputs that change slowly.
fn slowed(control: &Control, model: &Model, given: f64, half_period: f64) -> Control {
    let seconds = half_period / 1e3;
    let ranges = squared_ranges(control, model);
    let rate = SMOOTH * seconds * seconds / ranges;
    let freed = freed(control, given);
    Control {
        duration: Duration::Free {
            min: given,
            max: f64::max(LONGEST * given, SLOWEST * half_period),
            guess: half_period,
        },
        objective: Objective {
            rate: if rate.is_finite() { rate } else { 0.0 },
            ..freed.objective
        },
        ..freed
    }
}

/// Sum of the squared ranges of the inputs that are sought, in the units in which objectives count them; of unbounded ones their sizes.
fn squared_ranges(control: &Control, model: &Model) -> f64 {
    let inputs = [Role::Voltage, Role::Load].into_iter();
    let inputs = inputs.flat_map(|role| model.variables.with(role));
    let sought = inputs.filter(|input| !input.source.is_some_and(|s| control.is_given(s)));
    let ranges = sought.map(|input| {
        let [low, high] = control.bounds(input);
        let range = match (high - low).is_finite() {
            true => high - low,
            false => control.size(input, model),
        };
        let kind = model.input_kind(input.source.expect("an input of a source"));
        (range / kind.counted().1).powi(2)
    });
    ranges.sum()
}

/// Looks for the shortest motion that is no shorter than the one asked for, where that was not found: from the guess of the problem and
/// from a displaced one. What it says, and the motion where that is as short as is asked for; its iterations are put to those of the
/// `first` solve.
pub(crate) fn shortest(further: &Further<'_>, first: &mut Optimum) -> (Shortest, Option<Solution>) {
    let MotionTask {
        control, earlier, ..
    } = further.motion;
    let Duration::Given(given) = control.duration else {
        return (Shortest::Unknown, None);
    };
    let freed = freed(control, given);
    if !fits(&freed) {
        return (Shortest::Unknown, None);
    }
    let iterations = iterations(first);
    let displaced = match earlier {
        None => Some((displaced(&freed, first), None, ITERATIONS)),
        Some(_) => None,
    };
    let starts = [(freed, earlier, iterations)].into_iter().chain(displaced);
    let mut said = Shortest::Unknown;
    for (problem, earlier, iterations) in starts {
        let Some(found) = solved(further, first, &problem, earlier, iterations) else {
            break;
        };
        said = outcome(&found, given);
        let is_start = is_as_given(&found, given);
        if is_start || matches!(said, Shortest::Longer(_)) {
            return (said, is_start.then_some(found.motion));
        }
    }
    (said, None)
}

/// Looks for a motion that is about as slow as the slowest mode, where that is slower than what is asked for and no other start led anywhere.
/// As of [`shortest`]; `None` if it finds none, too.
pub(crate) fn slow(
    further: &Further<'_>,
    first: &mut Optimum,
) -> Option<(Shortest, Option<Solution>)> {
    let control = further.motion.control;
    let Duration::Given(given) = control.duration else {
        return None;
    };
    let half_period = first.half_period.filter(|half| *half > given)?;
    let problem = slowed(control, &first.model, given, half_period);
    if !fits(&problem) {
        return None;
    }
    let found = solved(further, first, &problem, None, ITERATIONS)?;
    let said = outcome(&found, given);
    let is_start = is_as_given(&found, given);
    let is_told = matches!(said, Shortest::AsGiven | Shortest::Longer(_));
    is_told.then(|| (said, is_start.then_some(found.motion)))
}

/// Iterations of a solve for the shortest motion.
fn iterations(first: &Optimum) -> usize {
    (TIMES * first.solution.iterations.len()).clamp(FEWEST, MOST)
}

/// Solves a problem with a free duration; its iterations are put to those of the `first` solve. `None` if it is time to stop.
fn solved(
    further: &Further<'_>,
    first: &mut Optimum,
    problem: &Control,
    earlier: Option<&Solution>,
    iterations: usize,
) -> Option<Optimum> {
    if further.is_over() {
        return None;
    }
    let mut go_on = |_: &Iterate<'_>| ControlFlow::Continue(());
    let found = further.solve(problem, earlier, iterations, &mut go_on)?;
    put_after(&mut first.solution, &found.solution);
    Some(found)
}

/// Returns true if a solve with a free duration ends at the given one.
fn is_as_given(found: &Optimum, given: f64) -> bool {
    let duration = found.motion.times[found.motion.intervals()];
    found.solution.status == Status::Solved && duration <= given * (1.0 + ON_BOUND)
}

/// Reads the end of a solve with a free duration for a given one. What its voltages do not reproduce is no advice.
fn outcome(found: &Optimum, given: f64) -> Shortest {
    match found.solution.status {
        Status::Solved if !found.is_solved() => Shortest::Unknown,
        Status::Solved if is_as_given(found, given) => Shortest::AsGiven,
        Status::Solved => Shortest::Longer(found.motion.times[found.motion.intervals()]),
        status if is_infeasible(status) => Shortest::NotUpTo(LONGEST * given),
        _ => Shortest::Unknown,
    }
}
