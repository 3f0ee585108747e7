//! A simulation: its motion, and the assessment of it.

use std::ops::ControlFlow;
use std::sync::Arc;

use crate::control::problem::{FeedbackControl, Simulation};
use crate::dynamics::trajectory::Trajectory;
use crate::dynamics::{
    DiscreteTrajectory, EnergyExchange, LocalError, local_error_of, out_of_domain, out_of_range,
};
use crate::ipopt::{Status, interrupt};
use crate::model::{Model, System};
use crate::tasks::moved_markers::moved_markers;
use crate::tasks::simulation_messages::{afterwards, timing};
use crate::workflow::WorkflowError;
use crate::workflow::accuracy::{Accuracy, AccuracyTarget};
use crate::workflow::closed_loop::ClosedLoop;
use crate::workflow::domain::{self, Outside};
use crate::workflow::grids::integrate_to;
use crate::workflow::integrate::{Simulated, grid, integrate_on};
use crate::workflow::longer_steps;
use crate::workflow::loop_limits::LoopLimits;
use crate::workflow::memory::{self, Occasion};
use crate::workflow::remark::{Remarks, STOPPED_EARLY};
use crate::workflow::stalled;
use crate::workflow::steps;
use crate::workflow::stops;
use crate::workflow::stretch_range;

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
        let outside = domain::records(&out_of_domain(model, discrete));
        let neglected =
            local_error_of(model, (discrete, trajectory), order).map(|local| match self.stopped {
                None => longer_steps::confirmed(&self.simulated, task, trajectory, local),
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
        remarks.note("step_divided", steps::divided(task));
        remarks.warn("outside_domain", domain::note(&outside, true));
        let beyond = out_of_range(model, discrete);
        remarks.warn("outside_range", stretch_range::warning(&beyond, true));
        remarks.note("stops", stops::notes(system, trajectory));
        remarks.warn("coarse_steps", steps::warning(neglected, discrete, task));
        remarks.warn("tolerance_exceeded", steps::beyond(*error, task));
        let unconfirmed = self
            .simulated
            .unconfirmed
            .filter(|_| self.stopped.is_none());
        remarks.warn(STOPPED_EARLY, unconfirmed.map(steps::unconfirmed));
        remarks.warn(
            "multigrid_stalled",
            stalled::warning(discrete.report.fallbacks),
        );
        remarks.warn("energy_balance", steps::unbalanced(discrete));
        remarks.warn("energy_balance", steps::unchecked(model, task));
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
    let watch = interrupt::watch(seconds);
    let (simulated, accuracy) = match wanted {
        None => {
            let (steps, _) = grid(task);
            let observer =
                |model: &Model, discrete: &DiscreteTrajectory| observer(steps, model, discrete);
            let simulated = integrate_on(system, task, begun, observer);
            (simulated.map_err(WorkflowError::unless_stopped)?, None)
        }
        Some(wanted) => {
            let refined = integrate_to(system, task, wanted, seconds, observer);
            let refined = refined.map_err(WorkflowError::unless_stopped)?;
            (refined.run, Some(refined.accuracy))
        }
    };
    // A finer grid that was stopped leaves the motion on the one before as it is.
    let is_early = ends_early(&simulated.discrete, task);
    let stopped = interrupt::stop().filter(|_| is_early);
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
    let open = integrate_on(system, &open, None, |_, _| match interrupt::stop() {
        Some(_) => ControlFlow::Break(()),
        None => ControlFlow::Continue(()),
    });
    let open = match open.map_err(WorkflowError::unless_stopped) {
        Err(WorkflowError::Stopped(status)) => return Ok((None, Some(status))),
        open => open?,
    };
    let is_early = ends_early(&open.discrete, task);
    let stopped = interrupt::stop().filter(|_| is_early);
    let reason =
        stopped.map(|status| format!("it was stopped ({})", status.word().replace('_', " ")));
    let failure = open.failure.map(|failure| failure.to_string());
    let open = (open.discrete, failure.or(reason));
    let (model, discrete) = (&simulated.model, &simulated.discrete);
    let counts = samples.clone();
    let mut out = ClosedLoop::new(model, counts, discrete, open);
    if let Some(ahead) = &controller.ahead {
        let _unwatched = interrupt::unwatched();
        out.limits = LoopLimits::new(ahead, (system, task), discrete)?;
    }
    Ok((Some(out), stopped))
}
