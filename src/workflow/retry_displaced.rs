//! Starts from elsewhere, before a problem is called infeasible.

use std::ops::ControlFlow;
use std::time::Instant;

use crate::control::Solution;
use crate::control::problem::{Control, MotionTask};
use crate::dynamics::stable_equilibrium;
use crate::workflow::coupled::{put_after, put_before};
use crate::workflow::motion::Iterate;
use crate::workflow::optimum::{Optimum, Restarted, Shortest, SolveLimits};
use crate::workflow::remark::phase;
use crate::workflow::restarts::{Further, ITERATIONS, displaced};
use crate::workflow::shortest::{shortest, slow};

/// Starts, in words.
const SHORTEST: &str = "the shortest motion";
const DISPLACED: &str = "a second, displaced initial guess";
const SLOW: &str = "a slow motion";

/// Solves a control problem again from other starts, where the first one led nowhere: from the shortest motion, where that is as short as is
/// asked for, and, unless it is longer, from a displaced guess; then it looks for a motion as slow as the slowest mode. The first solve, with
/// the iterations of all, where none leads anywhere.
pub(crate) fn second_starts(
    motion: MotionTask<'_>,
    first: Optimum,
    allowed: SolveLimits,
    observer: &mut dyn FnMut(&Iterate<'_>) -> ControlFlow<()>,
) -> Optimum {
    let further = Further {
        motion,
        allowed,
        began: Instant::now(),
    };
    let mut found = others(&further, first, observer);
    if !found.meets_equations() {
        found = advised(&further, found, observer);
    }
    if !found.meets_equations() {
        found.stopped = further.stopped();
    }
    found
}

/// Solves from the shortest motion, and from a displaced guess.
fn others(
    further: &Further<'_>,
    mut found: Optimum,
    observer: &mut dyn FnMut(&Iterate<'_>) -> ControlFlow<()>,
) -> Optimum {
    let MotionTask {
        control, earlier, ..
    } = further.motion;
    if further.is_over() {
        return found;
    }
    phase("looking for the shortest motion");
    let (said, motion) = shortest(further, &mut found);
    found.shortest = said;
    if let (Some(motion), false) = (motion, further.is_over()) {
        phase("solving from the shortest motion");
        let start = (control, Some(&motion));
        found = replaced(further, found, start, SHORTEST, observer);
    }
    let is_done = found.meets_equations() || matches!(said, Shortest::Longer(_));
    if !is_done && earlier.is_none() && !further.is_over() {
        phase(DISPLACED);
        let displaced = displaced(control, &found);
        found = replaced(further, found, (&displaced, None), DISPLACED, observer);
    }
    found
}

/// Looks for what the slowest mode says of a problem that no start solved, and solves from a slow motion that is as short as is asked for.
fn advised(
    further: &Further<'_>,
    mut found: Optimum,
    observer: &mut dyn FnMut(&Iterate<'_>) -> ControlFlow<()>,
) -> Optimum {
    if further.is_over() {
        return found;
    }
    phase("looking for the slowest mode");
    found.half_period = further.within(|| half_period(&found));
    if matches!(found.shortest, Shortest::Longer(_) | Shortest::AsGiven) {
        return found;
    }
    phase("looking for a slow motion");
    let Some((said, motion)) = slow(further, &mut found) else {
        return found;
    };
    found.shortest = said;
    match motion {
        Some(motion) if !further.is_over() => {
            let start = (further.motion.control, Some(&motion));
            replaced(further, found, start, SLOW, observer)
        }
        _ => found,
    }
}

/// Half a period in ms of the slowest vibration about rest: at the goal, or where that is no state of rest, under the voltages of the start.
fn half_period(found: &Optimum) -> Option<f64> {
    let Optimum {
        model, boundary, ..
    } = found;
    let of_goal = boundary.goal.rest.as_ref();
    let period = of_goal.and_then(|rest| rest.slowest_period(model));
    let of_start = || {
        let none = vec![0.0; model.sources.len()];
        let voltages = boundary.rest[0].as_ref().unwrap_or(&none);
        let rest = stable_equilibrium(model, &boundary.start.z, &model.scalars(voltages));
        rest.ok()?.slowest_period(model)
    };
    period.or_else(of_start).map(|period| 0.5 * period)
}

/// Returns the optimum of another start, or the result before where that finds none; with the iterations of both.
fn replaced(
    further: &Further<'_>,
    mut before: Optimum,
    (control, earlier): (&Control, Option<&Solution>),
    from: &'static str,
    observer: &mut dyn FnMut(&Iterate<'_>) -> ControlFlow<()>,
) -> Optimum {
    let Some(mut second) = further.solve(control, earlier, ITERATIONS, observer) else {
        return before;
    };
    if !second.meets_equations() {
        put_after(&mut before.solution, &second.solution);
        return before;
    }
    let first = before.solution.status;
    put_before(&mut second.solution, &before.solution);
    Optimum {
        setup: before.setup,
        carried: before.carried,
        restarted: Some(Restarted { first, from }),
        ..second
    }
}
