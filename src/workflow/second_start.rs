//! A second start from elsewhere, before a problem is called infeasible.

use crate::control::BoundaryConditions;
use crate::control::problem::{Control, Guess, Voltages};
use crate::ipopt::{SolverResult, Status};

/// Iterations of the second start; an optimum is found from it soon or not at all.
pub(crate) const ITERATIONS: usize = 100;

/// Returns true if a solve ended for want of a motion that keeps goal and limits.
pub(crate) fn is_infeasible(status: Status) -> bool {
    matches!(status, Status::Infeasible | Status::RestorationFailed)
}

/// Iterations after which a limit of them says something of the problem.
const MANY: usize = 50;

/// Returns true if a solve ended without a motion that keeps goal and limits, by its verdict or after many iterations, so that an explanation helps.
pub(crate) fn is_unreached(solution: &SolverResult) -> bool {
    let is_long = solution.iterations.len() > MANY;
    is_infeasible(solution.status) || (solution.status == Status::IterationLimit && is_long)
}

/// The problem with another guess: the motion under the voltages of the goal, or half of the largest ones; interpolated where it
/// was simulated.
pub(crate) fn displaced(
    control: &Control,
    boundary: &BoundaryConditions,
    sources: usize,
) -> Control {
    let [low, high] = control.voltage_bounds;
    let guess = match (&control.guess, &boundary.rest[1]) {
        (Guess::Simulate(_), _) => Guess::Interpolate,
        (_, Some(hold)) => Guess::Simulate(Voltages::Constant(hold.clone())),
        (_, None) => {
            // Without bounds nothing is known of the size of voltages.
            let half = 0.5 * (low + high);
            let half = if half.is_finite() { half } else { 0.0 };
            Guess::Simulate(Voltages::Constant(vec![half; sources]))
        }
    };
    Control {
        guess,
        ..control.clone()
    }
}

/// The better of two solves, with the iterations, evaluations and seconds of both.
pub(crate) fn one_of_both(first: SolverResult, second: SolverResult) -> SolverResult {
    let (mut kept, other, is_second) = match second.status.is_solved() {
        true => (second, first, true),
        false => (first, second, false),
    };
    let iterations = std::mem::take(&mut kept.iterations);
    kept.iterations = match is_second {
        true => other.iterations.into_iter().chain(iterations).collect(),
        false => iterations.into_iter().chain(other.iterations).collect(),
    };
    kept.seconds += other.seconds;
    kept.evaluations += other.evaluations;
    kept.failed_evaluations += other.failed_evaluations;
    kept
}
