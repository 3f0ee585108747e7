//! Solves of one control problem on several grids, within the limits of the whole.

use crate::control::problem::Control;
use crate::ipopt::Status;
use crate::model::System;
use crate::workflow::error::WorkflowError;
use crate::workflow::further::stopped;
use crate::workflow::iterate::Iterate;
use crate::workflow::optimise::optimise;
use crate::workflow::optimum::{Optimum, SolveLimits, seconds_left};
use std::ops::ControlFlow;
use std::time::Instant;

/// No grid has more variables than this.
pub(super) const VARIABLES: usize = 2_000_000;

/// Observer of the iterates on a number of intervals.
pub(super) type GridObserver<'a> = &'a mut dyn FnMut(usize, &Iterate<'_>) -> ControlFlow<()>;

/// The solves so far.
pub(super) struct GridSolves<'a> {
    system: &'a System,
    control: &'a Control,
    allowed: SolveLimits,
    observer: GridObserver<'a>,
    began: Instant,
    /// Iterations of all of them.
    pub(super) iterations: usize,
}

impl<'a> GridSolves<'a> {
    pub(super) fn new(
        system: &'a System,
        control: &'a Control,
        allowed: SolveLimits,
        observer: GridObserver<'a>,
    ) -> Self {
        Self {
            system,
            control,
            allowed,
            observer,
            began: Instant::now(),
            iterations: 0,
        }
    }

    /// Seconds left of those allowed.
    fn left(&self) -> Option<f64> {
        seconds_left(self.allowed.seconds, self.began)
    }

    /// Returns the reason why no further grid may be begun, if there is one.
    pub(super) fn stopped(&self) -> Option<Status> {
        stopped(self.left())
    }

    /// Returns true if no further grid may be begun.
    pub(super) fn is_over(&self) -> bool {
        self.stopped().is_some()
    }

    /// Solves on a number of intervals, from an earlier optimum or from the guess of the problem.
    ///
    /// # Errors
    /// As of [`optimise`].
    pub(super) fn solve(
        &mut self,
        intervals: usize,
        earlier: Option<&Optimum>,
    ) -> Result<Optimum, WorkflowError> {
        let control = Control {
            intervals,
            ..self.control.clone()
        };
        let limits = SolveLimits {
            seconds: self.left(),
            ..self.allowed
        };
        let earlier = earlier.map(|optimum| &optimum.motion);
        let observer = &mut self.observer;
        let found = optimise(self.system, &control, earlier, limits, &mut |iterate| {
            observer(intervals, iterate)
        })?;
        self.iterations += found.solution.iterations.len().saturating_sub(1);
        Ok(found)
    }
}
