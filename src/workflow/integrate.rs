//! A simulation in memory.

use crate::control::problem::{BoundaryState, Simulation, Voltages};
use crate::control::resolve_start;
use crate::dynamics::{
    DiscreteTrajectory, Drive, Inputs, Integrator, Lengths, Solving, StepControl, StepError,
    StepState, go_on,
};
use crate::math::in_order;
use crate::model::{Model, System};
use crate::nlp::Status;
use crate::stop;
use crate::workflow::accuracy::{
    AccuracyTarget, Attempt, ErrorSample, OF_CONTROL, Refined, refine,
};
use crate::workflow::control_loop::{Counts, Loop, horizon};
use crate::workflow::error::WorkflowError;
use crate::workflow::memory;
use crate::workflow::optimum::Budget;
use crate::workflow::remark::phase;
use crate::workflow::tolerance::{ByTolerance, EstimatedError, Found};
use std::ops::ControlFlow;
use std::time::Instant;

/// Order of the midpoint rule under voltages that are constant over its steps.
const OF_MOTION: f64 = 2.0;

/// A simulation and how it ended.
#[derive(Debug)]
pub struct Simulated {
    /// The model that moved.
    pub model: Model,
    /// The motion as far as it went.
    pub discrete: DiscreteTrajectory,
    /// Reason why it ended early.
    pub failure: Option<StepError>,
    /// Its error, where a tolerance controls its steps and it came to its end.
    pub error: Option<EstimatedError>,
    /// Reason why the error was not confirmed to be below the tolerance, where that was stopped.
    pub unconfirmed: Option<Status>,
    /// Counts of the samples of a controller.
    pub(crate) samples: Option<Counts>,
    /// Seconds before the first step.
    pub setup: f64,
    /// Seconds in the steps.
    pub seconds: f64,
}

/// Number of steps of a simulation, and their length in ms.
///
/// The steps are equal: as long as asked for, or a little shorter where they do not fit the duration.
///
/// If a tolerance controls the steps, their number is not known, and the length is that of the first attempt.
pub fn grid(task: &Simulation) -> (usize, f64) {
    if task.tolerance.is_some() {
        return (usize::MAX, task.step);
    }
    let steps = (task.duration / task.step - 1e-9).ceil().max(1.0) as usize;
    (steps, task.duration / steps as f64)
}

/// Simulates what a file asks for in memory; after every step `observer` sees the motion so far and may end it.
///
/// # Errors
/// The model or the start does not exist. A step that fails is no error: see the failure.
pub fn integrate(
    system: &System,
    task: &Simulation,
    observer: impl FnMut(&Model, &DiscreteTrajectory) -> ControlFlow<()>,
) -> Result<Simulated, WorkflowError> {
    integrate_on(system, task, None, observer)
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
    let budget = Budget::of_seconds(seconds);
    let (first, _) = grid(task);
    // Sampled voltages may change within a step.
    let order = match task.voltages.are_constant() {
        true => OF_MOTION,
        false => OF_CONTROL,
    };
    refine(
        wanted,
        order,
        || budget.stopped().map(Status::word),
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
            let status = match (&run.failure, budget.stopped()) {
                _ if is_complete => "simulated",
                (Some(_), _) => "step_failed",
                (None, stopped) => stopped.map_or("stopped", Status::word),
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

/// The same, from where a motion that has `begun` ends: the whole is to the bit what it would be without a stop.
///
/// # Errors
/// As of [`integrate`]; a motion of another model or method is a failure.
pub fn integrate_on(
    system: &System,
    task: &Simulation,
    begun: Option<DiscreteTrajectory>,
    mut observer: impl FnMut(&Model, &DiscreteTrajectory) -> ControlFlow<()>,
) -> Result<Simulated, WorkflowError> {
    let began = Instant::now();
    let (steps, h) = grid(task);
    let wrong = |error| WorkflowError::boundary("simulate", &error);
    phase("building");
    let model = Model::for_analysis(system.clone(), task.analysis(system, h))
        .map_err(|error| wrong(error.into()))?;
    if task.tolerance.is_none() {
        memory::of_motion(&model, steps)?;
    }
    has_solver(&model, task.solving)?;
    stop::check()?;
    phase("finding the start");
    let begun = begin(&model, task, begun)?;
    let setup = began.elapsed().as_secs_f64();
    phase("ordering and first factorisation");
    let horizon = horizon(task)?;
    let controlled = Loop::new(&model, task, horizon.as_ref())?;
    if let Some(controlled) = &controlled {
        controlled.observe(&begun);
    }
    let observer = |discrete: &DiscreteTrajectory| {
        if let Some(controlled) = &controlled {
            controlled.observe(discrete);
        }
        observer(&model, discrete)
    };
    let drive = Driven {
        model: &model,
        voltages: &task.voltages,
    };
    let switches = switches(&task.voltages, &model);
    let found = match task.tolerance {
        Some(tolerance) => ByTolerance {
            model: &model,
            solving: task.solving,
            control: StepControl {
                duration: task.duration,
                first: h,
                tolerance,
                switches: &switches,
            },
            drive: &drive,
        }
        .run(begun, observer),
        None => {
            let lengths = Lengths::Equal { h, steps };
            let drive: &dyn Drive = match &controlled {
                Some(controlled) => controlled,
                None => &drive,
            };
            let (motion, failure) = go_on(task.solving, &model, begun, lengths, drive, observer);
            Found {
                discrete: motion,
                failure,
                error: None,
                stopped: None,
            }
        }
    };
    let seconds = began.elapsed().as_secs_f64() - setup;
    let samples = controlled.map(|controlled| controlled.counts());
    Ok(Simulated {
        samples,
        model,
        discrete: found.discrete,
        failure: found.failure,
        error: found.error,
        unconfirmed: found.stopped,
        setup,
        seconds,
    })
}

/// Refuses an iteration with multigrid where nodes have not all unknowns.
fn has_solver(model: &Model, solving: Solving) -> Result<(), WorkflowError> {
    if !solving.multigrid.is_asked_for() {
        return Ok(());
    }
    let found = match solving.integrator {
        Integrator::Midpoint => model.node_grids().err().map(|none| none.to_string()),
        other => Some(format!("the integrator is {}", other.name())),
    };
    let expected = "\"auto\", \"faer\" or \"mumps\"; multigrid needs the midpoint rule and elastic blocks, beside which nothing moves";
    found.map_or(Ok(()), |found| {
        let reason = format!("found multigrid where {found}, expected {expected}");
        Err(WorkflowError::problem("simulate.linear_solver", reason))
    })
}

/// The motion that has begun, or its start.
fn begin(
    model: &Model,
    task: &Simulation,
    begun: Option<DiscreteTrajectory>,
) -> Result<DiscreteTrajectory, WorkflowError> {
    let wrong = |error| WorkflowError::boundary("simulate", &error);
    let of = StepState::equations_hash(model, task.solving);
    let mut begun = match begun {
        Some(begun) => begun,
        None => {
            let start = resolve_start(model, &task.start).map_err(wrong)?;
            let mut begun = DiscreteTrajectory::at(&start);
            if let BoundaryState::EndOf(end) = &task.start
                && end.method.of == of
            {
                begun.end = end.method.clone();
            }
            begun
        }
    };
    begun.end.of = of;
    Ok(begun)
}

/// Times in ms, in order, at which inputs or prescribed motions are not smooth.
fn switches(inputs: &Voltages, model: &Model) -> Vec<f64> {
    let of_motions = model.prescribed.iter().flat_map(|one| one.motion.corners());
    in_order(inputs.switches().into_iter().chain(of_motions))
}

/// The voltages of a task as the steps of its model ask for them.
pub(super) struct Driven<'a> {
    pub(super) model: &'a Model,
    pub(super) voltages: &'a Voltages,
}

impl Drive for Driven<'_> {
    fn at(&self, [from, to]: [f64; 2], part: f64) -> Vec<f64> {
        // A switch at an end of the step lies outside it, whichever way its time was rounded.
        let rounding = 4.0 * f64::EPSILON * to.abs().max(from.abs());
        let time = from + part * (to - from);
        let within = time.max(from + rounding).min(to - rounding);
        self.model.scalars(&self.voltages.at(within))
    }

    fn ends(&self, [from, to]: [f64; 2]) -> Option<[Inputs; 2]> {
        if self.voltages.are_constant_by_rows() {
            return None;
        }
        let rounding = 4.0 * f64::EPSILON * to.abs().max(from.abs());
        Some([from + rounding, to - rounding].map(|time| Inputs {
            values: self.model.scalars(&self.voltages.at(time)),
            rates: self.model.scalars(&self.voltages.rates(time)),
        }))
    }
}
