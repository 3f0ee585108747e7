//! The shortest motion to a goal that takes no less time than is asked for.

use std::ops::ControlFlow;

use crate::control::Solution;
use crate::control::problem::{Control, Duration, Objective};
use crate::ipopt::Status;
use crate::workflow::combined::put_after;
use crate::workflow::further::{Further, ITERATIONS, displaced, is_infeasible};
use crate::workflow::iterate::Iterate;
use crate::workflow::optimum::{Optimum, Shortest};

/// Largest free duration and the first one, as multiples of the given one.
const LONGEST: f64 = 20.0;
const FIRST: f64 = 2.0;
/// Iterations of its solve, as a multiple of those of the first one, within these limits.
const TIMES: usize = 2;
const FEWEST: usize = 60;
const MOST: usize = 200;
/// A free duration that is longer by no more than this part lies on its lower bound.
const ON_BOUND: f64 = 1e-5;

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

/// Looks for the shortest motion that is no shorter than the one asked for, where that was not found: from the guess of the problem and
/// from a displaced one. What it says, and the motion; its iterations are put to those of the `first` solve.
pub(crate) fn shortest(
    further: &Further<'_>,
    first: &mut Optimum,
    earlier: Option<&Solution>,
) -> (Shortest, Option<Solution>) {
    let Duration::Given(given) = further.control.duration else {
        return (Shortest::Unknown, None);
    };
    let freed = freed(further.control, given);
    let iterations = TIMES * first.solution.iterations.len();
    let iterations = iterations.clamp(FEWEST, MOST);
    let displaced = match earlier {
        None => Some((displaced(&freed, first), None, ITERATIONS)),
        Some(_) => None,
    };
    let starts = [(freed, earlier, iterations)].into_iter().chain(displaced);
    let mut said = Shortest::Unknown;
    for (problem, earlier, iterations) in starts {
        if further.is_over() {
            break;
        }
        let mut go_on = |_: &Iterate<'_>| ControlFlow::Continue(());
        let found = further.solve(&problem, earlier, iterations, &mut go_on);
        let Some(found) = found else {
            break;
        };
        put_after(&mut first.solution, &found.solution);
        said = outcome(&found, given);
        if matches!(said, Shortest::AsGiven | Shortest::Longer(_)) {
            return (said, Some(found.motion));
        }
    }
    (said, None)
}

/// Reads the end of a solve with a free duration for a given one.
fn outcome(found: &Optimum, given: f64) -> Shortest {
    let duration = found.motion.times[found.motion.intervals()];
    match found.solution.status {
        Status::Solved if duration <= given * (1.0 + ON_BOUND) => Shortest::AsGiven,
        // A longer one that its voltages do not reproduce is no advice.
        Status::Solved if found.is_solved() => Shortest::Longer(duration),
        status if is_infeasible(status) => Shortest::NotUpTo(LONGEST * given),
        _ => Shortest::Unknown,
    }
}
