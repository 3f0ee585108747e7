//! Starts from elsewhere, before a problem is called infeasible.

use std::ops::ControlFlow;
use std::time::Instant;

use crate::control::Solution;
use crate::control::problem::Control;
use crate::model::System;
use crate::workflow::combined::{put_after, put_before};
use crate::workflow::further::{Further, ITERATIONS, displaced};
use crate::workflow::iterate::Iterate;
use crate::workflow::optimum::{Optimum, Restarted, Shortest, SolveLimits};
use crate::workflow::phase::phase;
use crate::workflow::shortest::shortest;

/// Starts, in words.
const SHORTEST: &str = "the shortest motion";
const DISPLACED: &str = "a second, displaced initial guess";

/// Solves a control problem again from other starts, where the first one led nowhere: from the shortest motion, where that is as short as is
/// asked for, and, unless it is longer, from a displaced guess. The first solve, with the iterations of all, where none leads anywhere.
pub(crate) fn second_starts(
    system: &System,
    control: &Control,
    (first, earlier): (Optimum, Option<&Solution>),
    allowed: SolveLimits,
    observer: &mut dyn FnMut(&Iterate<'_>) -> ControlFlow<()>,
) -> Optimum {
    let further = Further {
        system,
        control,
        allowed,
        began: Instant::now(),
    };
    let mut found = first;
    if further.is_over() {
        return found;
    }
    phase("looking for the shortest motion");
    let (said, motion) = shortest(&further, &mut found, earlier);
    found.shortest = said;
    if let (Shortest::AsGiven, Some(motion), false) = (said, motion, further.is_over()) {
        phase("solving from the shortest motion");
        found = replaced(
            &further,
            found,
            (control, Some(&motion)),
            SHORTEST,
            observer,
        );
    }
    let is_done = found.meets_equations() || matches!(said, Shortest::Longer(_));
    if !is_done && earlier.is_none() && !further.is_over() {
        phase(DISPLACED);
        let displaced = displaced(control, &found);
        found = replaced(&further, found, (&displaced, None), DISPLACED, observer);
    }
    found
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
