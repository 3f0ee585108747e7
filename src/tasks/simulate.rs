//! A simulation: its motion, and the assessment of it.

use crate::control::problem::{Afterwards, Disturbed, FeedbackControl, Simulation, TableEnd};
use crate::dynamics::trajectory::Trajectory;
use crate::dynamics::{
    DiscreteTrajectory, EnergyExchange, LocalError, local_error, out_of_domain, out_of_range,
    short_touches, wrinkles,
};
use crate::math::significant;
use crate::model::{Model, System};
use crate::nlp::Status;
use crate::stop::{self, Stopped};
use crate::tasks::check::moved_markers;
use crate::workflow::accuracy::{Accuracy, AccuracyTarget};
use crate::workflow::closed_loop::{ClosedLoop, DisturbedLoop, LoopLimits};
use crate::workflow::integrate::{Simulated, grid, integrate_on, integrate_to};
use crate::workflow::memory::Occasion;
use crate::workflow::remark::{Remarks, STOPPED_EARLY};
use crate::workflow::warnings::Outside;
use crate::workflow::{WorkflowError, infeasible, memory, warnings};
use std::ops::ControlFlow;
use std::sync::Arc;
use std::time::Instant;

/// Options of a simulation in addition to its problem.
#[derive(Debug, Default)]
pub struct SimulationRequest {
    /// Accuracy of the steps; nothing takes those of the problem.
    pub wanted: Option<AccuracyTarget>,
    /// A motion that has begun and is to go on.
    pub begun: Option<DiscreteTrajectory>,
    /// Seconds after which it is to end.
    pub seconds: Option<f64>,
}

/// A simulation that has ended, before its time where it failed or was stopped.
#[derive(Debug)]
pub struct SimulationResult {
    /// The motion, on the grid that was taken.
    pub simulated: Simulated,
    /// Status of a run that was stopped before its end, or before that of the motion to which a controller is compared.
    pub stopped: Option<Status>,
    /// Estimated errors, where an accuracy was wanted.
    pub accuracy: Option<Accuracy>,
    /// Deviations from the motion of a controller.
    pub closed_loop: Option<ClosedLoop>,
}

/// Energies, errors and remarks of a simulation.
#[derive(Debug)]
pub struct Assessment {
    /// Energies from the sources.
    pub exchange: EnergyExchange,
    /// The sum of the local errors of the steps.
    pub neglected: Option<LocalError>,
    /// Muscles and blocks outside the domain of their material.
    pub outside: Vec<Outside>,
    /// Warnings and notes.
    pub remarks: Remarks,
}

impl SimulationResult {
    /// Its status.
    pub fn word(&self) -> &'static str {
        match (&self.simulated.failure, self.stopped) {
            (Some(_), _) => "step_failed",
            (None, Some(stopped)) => stopped.word(),
            (None, None) => "simulated",
        }
    }

    /// Length of its motion in ms.
    pub fn reached(&self) -> f64 {
        let discrete = &self.simulated.discrete;
        discrete.times[discrete.intervals()]
    }

    /// Assesses it: a part of its own, since of many steps it takes long, and files can be written meanwhile. `trajectory` is the motion
    /// as positions and voltages.
    pub fn assess(
        &self,
        system: &System,
        task: &Simulation,
        trajectory: &Trajectory,
    ) -> Assessment {
        let Simulated {
            model,
            discrete,
            error,
            ..
        } = &self.simulated;
        let order = task.solving.integrator.order();
        let ends = [task.start.voltages(), None];
        let outside = warnings::outside_domain(&out_of_domain(model, discrete));
        let local = local_error(model, discrete, trajectory, order);
        let neglected = local.map(|local| match self.stopped {
            None => warnings::confirmed(&self.simulated, task, trajectory, local),
            Some(_) => local,
        });
        let mut remarks = Remarks::default();
        remarks.note("start", task.start.notes().iter().cloned());
        remarks.note("moved_marker", moved_markers(system));
        remarks.warn("singular_loops", model.loops.warning.clone());
        remarks.note("voltages_end", afterwards(task));
        if let Some(closed) = &self.closed_loop {
            remarks.note("feedback", closed.notes());
            remarks.warn("goal_missed", closed.missed(model.length()));
            remarks.warn("feedback_timing", timing(task));
            remarks.warn("plan_failed", closed.other_sources());
            remarks.warn("open_loop_early", closed.open_loop_early());
            if let Some(limits) = &closed.limits {
                limits.remark(&mut remarks);
            }
            remarks.note("at_lower_bound", closed.at_lower_bound());
            remarks.warn("at_upper_bound", closed.at_upper_bound());
        }
        remarks.note("step_divided", warnings::divided(task));
        remarks.warn("outside_domain", warnings::domain_note(&outside, true));
        let wrinkles = wrinkles(model, discrete);
        remarks.warn("wrinkles", warnings::wrinkle_warning(&wrinkles, true));
        let beyond = out_of_range(model, discrete);
        let beyond = warnings::stretch_range_warning(&beyond, true);
        remarks.warn("outside_range", beyond);
        remarks.note("stops", infeasible::stop_notes(system, trajectory));
        remarks.warn("coarse_steps", warnings::warning(neglected, discrete, task));
        let short = warnings::short_touch_warning(&short_touches(model, discrete));
        remarks.warn("coarse_touches", short);
        remarks.warn("tolerance_exceeded", warnings::beyond(*error, task));
        let unconfirmed = self.simulated.unconfirmed;
        let unconfirmed = unconfirmed.filter(|_| self.stopped.is_none());
        remarks.warn(STOPPED_EARLY, unconfirmed.map(warnings::unconfirmed));
        let stalled = infeasible::stalled_warning(discrete.report.fallbacks);
        remarks.warn("multigrid_stalled", stalled);
        remarks.warn("energy_balance", warnings::unbalanced(discrete));
        Assessment {
            exchange: EnergyExchange::new(&model.system, trajectory, ends),
            neglected,
            outside,
            remarks,
        }
    }
}

/// Simulates, in the steps of the task or in finer ones; the result is then [assessed](SimulationResult::assess). After every step `observer` sees their number on the present grid and the motion so
/// far.
///
/// # Errors
/// The model or the start does not exist, or the machine has no room. A step that fails is no error: see the failure.
pub fn simulate(
    system: &System,
    task: &Simulation,
    request: SimulationRequest,
    observer: &mut dyn FnMut(usize, &Model, &DiscreteTrajectory) -> ControlFlow<()>,
) -> Result<SimulationResult, WorkflowError> {
    memory::of_elements(system, Occasion::of_steps(task.solving))?;
    let SimulationRequest {
        wanted,
        begun,
        seconds,
    } = request;
    let watch = stop::watch(seconds);
    let (simulated, accuracy) = match wanted {
        None => {
            let (steps, _) = grid(task);
            let observer =
                |model: &Model, discrete: &DiscreteTrajectory| observer(steps, model, discrete);
            let simulated = integrate_on(system, task, begun, observer);
            (simulated.map_err(stop::unless_stopped)?, None)
        }
        Some(wanted) => {
            let refined = integrate_to(system, task, wanted, seconds, observer);
            let refined = refined.map_err(stop::unless_stopped)?;
            (refined.run, Some(refined.accuracy))
        }
    };
    // A finer grid that was stopped leaves the motion on the one before as it is.
    let is_early = ends_early(&simulated.discrete, task);
    let stopped = stop::reason().filter(|_| is_early);
    let (closed_loop, without) = match stopped {
        None => closed_loop(system, task, &simulated)?,
        Some(_) => (None, None),
    };
    drop(watch);
    Ok(SimulationResult {
        closed_loop,
        simulated,
        stopped: stopped.or(without),
        accuracy,
    })
}

/// Returns true if a motion does not last as long as it was to.
fn ends_early(discrete: &DiscreteTrajectory, task: &Simulation) -> bool {
    discrete.times[discrete.intervals()] < task.duration * (1.0 - 1e-12)
}

/// The deviations of a motion under a controller from that of its law, next to those of the motion without corrections, and the reason why that one was
/// stopped.
fn closed_loop(
    system: &System,
    task: &Simulation,
    simulated: &Simulated,
) -> Result<(Option<ClosedLoop>, Option<Status>), WorkflowError> {
    let (Some(controller), Some(samples)) = (&task.controller, &simulated.samples) else {
        return Ok((None, None));
    };
    let open = Simulation {
        controller: Some(Box::new(FeedbackControl {
            law: Arc::new(samples.law.open()),
            ahead: None,
            ..controller.as_ref().clone()
        })),
        ..task.clone()
    };
    let open = integrate_on(system, &open, None, |_, _| {
        stop::check().map_or(ControlFlow::Break(()), ControlFlow::Continue)
    });
    let open = match open.map_err(stop::unless_stopped) {
        Err(WorkflowError::Stopped(Stopped(status))) => return Ok((None, Some(status))),
        open => open?,
    };
    let is_early = ends_early(&open.discrete, task);
    let stopped = stop::reason().filter(|_| is_early);
    let reason =
        stopped.map(|status| format!("it was stopped ({})", status.word().replace('_', " ")));
    let failure = open.failure.map(|failure| failure.to_string());
    let open = (open.discrete, failure.or(reason));
    let (model, discrete) = (&simulated.model, &simulated.discrete);
    let counts = samples.clone();
    let mut out = ClosedLoop::new(model, counts, discrete, open);
    if let Some(ahead) = &controller.ahead {
        let _unwatched = stop::unwatched();
        out.limits = LoopLimits::new(ahead, system, task, discrete)?;
    }
    Ok((Some(out), stopped))
}

/// Notes the voltages after the end of the solution from which a simulation takes them, where it goes on for longer.
pub(super) fn afterwards(task: &Simulation) -> Option<String> {
    let TableEnd {
        time: end,
        afterwards,
        solution,
    } = task.voltages.table.as_ref()?;
    let named = solution.as_ref().map(|path| path.display().to_string());
    let of_solution = named.is_some();
    let source = named.unwrap_or_else(|| "the table".to_owned());
    let is_longer = task.duration > end * (1.0 + 1e-9);
    let end = end / 1e3;
    is_longer.then(|| match afterwards {
        Afterwards::Held if of_solution => {
            format!("after {end} s the voltages that hold the goal of {source} are held")
        }
        Afterwards::Held => format!("after {end} s the voltages of \"hold\" are held"),
        Afterwards::OfLastInterval => {
            let goal = if of_solution { ", voltages that hold its goal" } else { "" };
            format!(
                "after {end} s the voltages of the last interval are held: {source} has no \"hold\"{goal}"
            )
        }
    })
}

/// Warnings that a controller samples or acts in other times than those for which its gains are.
pub(super) fn timing(task: &Simulation) -> Vec<String> {
    // What plans anew does so in its own times.
    let controller = task.controller.as_ref();
    let Some(controller) = controller.filter(|one| one.ahead.is_none()) else {
        return Vec::new();
    };
    let law = &controller.law;
    let predicted = law.delay as f64 * law.h;
    let of = |what: &str, time: f64, of_gains: f64| {
        let seconds = |ms: f64| significant(1e-3 * ms, 4);
        let differs = (time - of_gains).abs() > 1e-9 * law.h;
        differs.then(|| {
            format!(
                "the controller runs with a {what} of {} s, its gains were designed for {} s; stability is not guaranteed",
                seconds(time),
                seconds(of_gains)
            )
        })
    };
    let both = [
        of("time between samples", controller.sample, law.h),
        of("delay", controller.delay, predicted),
    ];
    both.into_iter().flatten().collect()
}

/// Closed loops with parts of a disturbance.
#[derive(Debug, Default)]
pub struct DisturbedLoops {
    /// Those that were simulated.
    pub loops: Vec<DisturbedLoop>,
    /// Reasons why others are left out.
    pub left_out: Vec<String>,
    /// Status of a run that was stopped before all of them ended.
    pub stopped: Option<Status>,
}

/// Closed loops with all parts of a disturbance, next to that of the whole, which has been simulated. They end after a number of seconds.
///
/// # Errors
/// A model or a start does not exist.
pub fn disturbed(
    parts: &[Disturbed],
    whole: &SimulationResult,
    seconds: Option<f64>,
) -> Result<DisturbedLoops, WorkflowError> {
    let began = Instant::now();
    let mut out = DisturbedLoops::default();
    if whole.closed_loop.is_none() {
        return Ok(out);
    }
    let go_on = &mut |_: usize, _: &_, _: &_| {
        stop::check().map_or(ControlFlow::Break(()), ControlFlow::Continue)
    };
    for Disturbed { size, system, task } in parts {
        let simulated;
        let mut found = whole;
        if *size != DisturbedLoop::WHOLE {
            let request = SimulationRequest {
                seconds: seconds.map(|limit| limit - began.elapsed().as_secs_f64()),
                ..SimulationRequest::default()
            };
            simulated = match simulate(system, task, request, go_on) {
                Err(WorkflowError::Stopped(Stopped(status))) => {
                    out.left_out.push(not_whole(*size));
                    out.stopped = Some(status);
                    continue;
                }
                found => found?,
            };
            found = &simulated;
        }
        out.stopped = out.stopped.or(found.stopped);
        if let Some(failure) = &found.simulated.failure {
            out.left_out.push(format!(
                "the motion with {size} of the disturbance ends early: {failure}"
            ));
        }
        match &found.closed_loop {
            Some(closed) => out.loops.push(DisturbedLoop {
                size: *size,
                times: found.simulated.discrete.times.clone(),
                closed: closed.clone(),
            }),
            None => out.left_out.push(not_whole(*size)),
        }
    }
    Ok(out)
}

fn not_whole(size: f64) -> String {
    format!("{size} of the disturbance was not simulated to the end: the run was stopped before")
}
