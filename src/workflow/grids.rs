//! Control problems and simulations on as fine a grid as an accuracy needs.

use crate::control::problem::{Control, Duration, Simulation, Voltages};
use crate::dynamics::DiscreteTrajectory;
use crate::model::{Model, System};
use crate::nlp::Status;
use crate::stop;
use crate::workflow::accuracy::{AccuracyTarget, Attempt, Refined, refine};
use crate::workflow::error::WorkflowError;
use crate::workflow::estimate::ErrorSample;
use crate::workflow::integrate::{Simulated, grid, integrate};
use crate::workflow::motion;
use crate::workflow::motion::Iterate;
use crate::workflow::optimise::optimise;
use crate::workflow::optimum::{Optimum, SolveLimits, seconds_left};
use crate::workflow::restarts::stopped;
use std::ops::ControlFlow;
use std::time::Instant;

/// The solver's tolerance as a part of the accuracy asked for, where the problem names no smaller one.
pub(super) const SOLVER: f64 = 1e-2;
/// Order of optimal voltages until three grids show it: switches and the cost of the first and last jump may make it one.
pub(super) const OF_CONTROL: f64 = 1.0;
/// Order of the midpoint rule under voltages that are constant over its steps.
const OF_MOTION: f64 = 2.0;

/// Solves a control problem on its own grid, then on finer ones, each from the solution before, until every error is
/// estimated below what is wanted; or estimates the error on its own grid. `observer` sees the number of intervals and every
/// iteration.
///
/// # Errors
/// As of [`optimise`].
pub fn optimise_to(
    system: &System,
    control: &Control,
    wanted: AccuracyTarget,
    allowed: SolveLimits,
    observer: &mut dyn FnMut(usize, &Iterate<'_>) -> ControlFlow<()>,
) -> Result<Refined<Optimum>, WorkflowError> {
    let began = Instant::now();
    let left = || seconds_left(allowed.seconds, began);
    let mut refined = refine(
        wanted,
        OF_CONTROL,
        || stop(left()),
        |times, before: Option<&Optimum>| {
            let mut control = control.clone();
            control.intervals *= times;
            if let AccuracyTarget::Below(error) = wanted {
                control.solver.tolerance = control.solver.tolerance.min(SOLVER * error);
            }
            let seconds = left();
            let limits = SolveLimits { seconds, ..allowed };
            let earlier = before.map(|optimum| &optimum.motion);
            let mut run = optimise(system, &control, earlier, limits, &mut |iterate| {
                observer(control.intervals, iterate)
            })?;
            // What the guess of the problem became belongs to all grids.
            run.carried = before.map_or(run.carried, |optimum| optimum.carried);
            // What is not reproduced may be on a finer grid.
            let is_complete = run.meets_equations();
            let sample = match is_complete {
                true => sample(&run, &control),
                false => ErrorSample::default(),
            };
            Ok(Attempt {
                sample,
                intervals: control.intervals,
                iterations: run.solution.iterations.len().saturating_sub(1),
                variables: run.solution.x.len(),
                status: run.word(),
                is_complete,
                run,
            })
        },
    )?;
    if refined.run.meets_equations() && !refined.run.is_solved() {
        refined.run.stopped = stopped(left());
    }
    Ok(refined)
}

/// Simulates with the step of the task, then with half of it and so on, until every error is estimated below what is wanted;
/// or estimates the error with its own step. `observer` sees the number of steps, and the motion after each step.
///
/// # Errors
/// As of [`integrate`].
pub fn integrate_to(
    system: &System,
    task: &Simulation,
    wanted: AccuracyTarget,
    seconds: Option<f64>,
    observer: &mut dyn FnMut(usize, &Model, &DiscreteTrajectory) -> ControlFlow<()>,
) -> Result<Refined<Simulated>, WorkflowError> {
    let began = Instant::now();
    let left = || seconds.map(|s| s - began.elapsed().as_secs_f64());
    let (first, _) = grid(task);
    // Sampled voltages may change within a step.
    let order = match task.voltages {
        Voltages::Constant(_) => OF_MOTION,
        Voltages::Sampled { .. } | Voltages::Signals(_) => OF_CONTROL,
    };
    refine(
        wanted,
        order,
        || stop(left()),
        |times, _| {
            let steps = first * times;
            let task = Simulation {
                step: task.duration / steps as f64,
                ..task.clone()
            };
            let run = integrate(system, &task, |model, discrete| {
                observer(steps, model, discrete)
            })?;
            let is_complete = run.failure.is_none() && run.discrete.intervals() == steps;
            let status = match (&run.failure, stop(left())) {
                _ if is_complete => "simulated",
                (Some(_), _) => "step_failed",
                (None, stopped) => stopped.unwrap_or("stopped"),
            };
            Ok(Attempt {
                sample: match is_complete {
                    true => ErrorSample::of_motion(&run.model, &run.discrete),
                    false => ErrorSample::default(),
                },
                intervals: run.discrete.intervals(),
                iterations: run.discrete.report.iterations,
                variables: steps * run.model.action.map.unknowns(),
                status,
                is_complete,
                run,
            })
        },
    )
}

/// Returns the reason why no other run may begin.
pub(super) fn stop(seconds: Option<f64>) -> Option<&'static str> {
    match seconds {
        _ if stop::requested() => Some("interrupted"),
        Some(seconds) if seconds <= 0.0 => Some("time_limit"),
        _ => None,
    }
}

/// Returns the values of an optimum that are compared.
pub(super) fn sample(optimum: &Optimum, control: &Control) -> ErrorSample {
    let kept = &optimum.motion;
    let is_free = matches!(control.duration, Duration::Free { .. });
    let sample = ErrorSample {
        objective: Some(optimum.solution.objective),
        duration: is_free.then(|| kept.times[kept.intervals()]),
        ..ErrorSample::of_motion(
            &optimum.model,
            &motion::discrete_trajectory(&optimum.model, kept),
        )
    };
    ErrorSample {
        response: Some(response(optimum, &sample)),
        ..sample
    }
}

/// Deviation of an optimal motion from the one under its voltages with half the step; infinite where there is none.
fn response(optimum: &Optimum, optimal: &ErrorSample) -> f64 {
    let tested = optimum.resimulation.as_ref();
    let half = tested.and_then(|tested| tested.half.as_ref());
    half.map_or(f64::INFINITY, |discrete| {
        optimal.deviation(&ErrorSample::of_motion(&optimum.model, discrete))
    })
}

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
