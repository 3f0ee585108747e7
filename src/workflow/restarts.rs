//! Further starts of a control problem whose first one led nowhere: when they are taken, their guesses and limits.

use std::ops::ControlFlow;
use std::time::Instant;

use crate::control::Solution;
use crate::control::problem::{Control, Guess, MotionTask, Voltages};
use crate::ipopt::SolverResult;
use crate::nlp::Status;
use crate::stop;
use crate::workflow::attempt::attempt;
use crate::workflow::motion::Iterate;
use crate::workflow::optimum::{Optimum, SolveLimits, seconds_left};

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

/// Returns the reason why no further solve may be begun with these seconds left, if there is one.
pub(crate) fn stopped(left: Option<f64>) -> Option<Status> {
    if stop::requested() {
        return Some(Status::Interrupted);
    }
    let is_late = left.is_some_and(|seconds| seconds <= 0.0);
    stop::reason().or(is_late.then_some(Status::TimeLimit))
}

/// The problem with another guess: the motion under the voltages of the goal, or half of the largest ones; interpolated where it
/// was simulated.
pub(crate) fn displaced(control: &Control, first: &Optimum) -> Control {
    let [low, high] = control.voltage_bounds;
    let guess = match (&control.guess, &first.boundary.rest[1]) {
        (Guess::Simulate(_), _) => Guess::Interpolate,
        (_, Some(hold)) => Guess::Simulate(Voltages::Constant(hold.clone())),
        (_, None) => {
            // Without bounds nothing is known of the size of voltages.
            let half = 0.5 * (low + high);
            let half = if half.is_finite() { half } else { 0.0 };
            let sources = first.model.sources.iter();
            let row = sources.map(|source| if source.is_load() { 0.0 } else { half });
            Guess::Simulate(Voltages::Constant(row.collect()))
        }
    };
    Control {
        guess,
        ..control.clone()
    }
}

/// Further starts of a control problem, and what they may take.
pub(crate) struct Further<'a> {
    pub(crate) motion: MotionTask<'a>,
    pub(crate) allowed: SolveLimits,
    pub(crate) began: Instant,
}

impl Further<'_> {
    /// Seconds that are left, where they are limited.
    fn seconds(&self) -> Option<f64> {
        seconds_left(self.allowed.seconds, self.began)
    }

    /// Returns the reason why nothing more may be begun, if there is one.
    pub(crate) fn stopped(&self) -> Option<Status> {
        stopped(self.seconds())
    }

    /// Returns true if nothing more may be begun.
    pub(crate) fn is_over(&self) -> bool {
        self.stopped().is_some()
    }

    /// Does a piece of work that asks whether it is to stop.
    pub(crate) fn within<T>(&self, work: impl FnOnce() -> T) -> T {
        let _watch = stop::watch(self.seconds());
        work()
    }

    /// Solves a problem of the same system, within a number of iterations; none where it cannot be stated.
    pub(crate) fn solve(
        &self,
        control: &Control,
        earlier: Option<&Solution>,
        iterations: usize,
        observer: &mut dyn FnMut(&Iterate<'_>) -> ControlFlow<()>,
    ) -> Option<Optimum> {
        let most = self.allowed.iterations;
        let most = most.unwrap_or(self.motion.control.solver.max_iterations);
        let limits = SolveLimits {
            iterations: Some(iterations.min(most)),
            seconds: self.seconds(),
        };
        let motion = MotionTask {
            control,
            earlier,
            ..self.motion
        };
        let found = attempt(&motion.into(), limits, observer).ok();
        found.map(|mut found| found.optima.remove(0))
    }
}
