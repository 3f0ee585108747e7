//! A control problem: solved, verified by a simulation, and held after its end.

use std::ops::ControlFlow;

use crate::control::hold_obstacle;
use crate::control::problem::{Control, ControlTask, MotionTask};
use crate::dynamics::trajectory::Trajectory;
use crate::dynamics::{DiscreteTrajectory, EnergyExchange, out_of_domain, out_of_range};
use crate::model::System;
use crate::sensitivity::{self, Gradients, NoSensitivity, Sensitivity, gradients, sensitivities};
use crate::tasks::check::moved_markers;
use crate::tasks::held_goal::{HeldGoals, solve_and_hold};
use crate::tasks::solve_messages::{self, Verdict, carried, ends, restarted};
use crate::workflow::accuracy::Accuracy;
use crate::workflow::domain::{self, Outside};
use crate::workflow::hold_check::{self, free_end};
use crate::workflow::infeasible::explain;
use crate::workflow::loop_limits::LoopLimits;
use crate::workflow::memory::{self, Occasion};
use crate::workflow::motion::{discrete_trajectory, trajectory};
use crate::workflow::optimum::Optimum;
use crate::workflow::period::Repeated;
use crate::workflow::remark::{Remarks, STOPPED_EARLY};
use crate::workflow::resimulate::Resimulation;
use crate::workflow::restarts::is_unreached;
use crate::workflow::tracking::{FinalValue, Tracked, final_values, followed};
use crate::workflow::{Iterate, SolveRequest, WholeProgram, WorkflowError, infeasible};

/// An optimal motion, or the last iterate of a solve that found none.
#[derive(Debug)]
pub struct SolveResult {
    /// The optimum, with its model.
    pub optimum: Optimum,
    /// Iterations on all grids.
    pub iterations: usize,
    /// Estimated errors, where an accuracy was wanted of a problem that names its intervals.
    pub accuracy: Option<Accuracy>,
    /// The verdict.
    pub verdict: Verdict,
    /// The motion as unknowns of its model.
    pub discrete: DiscreteTrajectory,
    /// The motion as positions and voltages.
    pub trajectory: Trajectory,
    /// Energies from the sources.
    pub exchange: EnergyExchange,
    /// Deviations from the references of the objective.
    pub tracking: Vec<Tracked>,
    /// Values at waypoints for which costs ask.
    pub waypoint_values: Vec<FinalValue>,
    /// Values at the end for which final costs ask.
    pub final_values: Vec<FinalValue>,
    /// Derivatives of the optimum by the numbers that the problem names; none where they do not exist, which a remark says.
    pub sensitivities: Vec<Sensitivity>,
    /// Derivatives of the outcomes that it names, where it names some.
    pub gradients: Option<Gradients>,
    /// Muscles and blocks outside the domain of their material.
    pub outside: Vec<Outside>,
    /// Warnings and notes.
    pub remarks: Remarks,
}

/// Solves a control problem; an optimum that a simulation under its voltages does not reproduce is solved again on finer grids. `observer`
/// sees the number of intervals and every iterate.
///
/// # Errors
/// Start, goal, guess or an option of the solver is wrong, or the machine has no room. A problem without a solution is no error: see the
/// verdict.
pub fn solve(
    system: &System,
    control: &Control,
    request: SolveRequest,
    observer: &mut dyn FnMut(usize, &Iterate<'_>) -> ControlFlow<()>,
) -> Result<SolveResult, WorkflowError> {
    let task = MotionTask::alone(system, control).into();
    let mut solved = solve_task(&task, request, observer)?;
    let mut result = solved.list.remove(0);
    result.accuracy = solved.accuracy;
    let cut_short = result.optimum.cut_short.map(solve_messages::cut_short);
    result.remarks.warn(STOPPED_EARLY, cut_short);
    Ok(result)
}

/// Motions of a task, each with its verdict, and numbers of all of them.
pub(super) struct Solved {
    pub(super) list: Vec<SolveResult>,
    pub(super) whole: WholeProgram,
    pub(super) iterations: usize,
    pub(super) accuracy: Option<Accuracy>,
}

/// Solves a task of one motion or several.
///
/// # Errors
/// As of [`solve`].
pub(super) fn solve_task(
    task: &ControlTask<'_>,
    request: SolveRequest,
    observer: &mut dyn FnMut(usize, &Iterate<'_>) -> ControlFlow<()>,
) -> Result<Solved, WorkflowError> {
    for motion in &task.motions {
        memory::of_elements(motion.system, Occasion::Factors)?;
    }
    if let [one] = &task.motions[..] {
        sensitivity::check(one.system, one.control).map_err(|(name, reason)| {
            WorkflowError::Problem {
                place: format!("control.sensitivity.{name}"),
                reason,
            }
        })?;
    }
    let HeldGoals {
        found,
        controls,
        notes,
    } = solve_and_hold(task, request, observer)?;
    let each = task.motions.iter().zip(&controls).zip(found.optima);
    let notes = found.notes.into_iter().zip(notes);
    let list = each
        .zip(notes)
        .map(|(((motion, control), optimum), notes)| {
            assessed(motion.system, control, optimum, found.iterations, notes)
        });
    Ok(Solved {
        list: list.collect(),
        whole: found.whole,
        iterations: found.iterations,
        accuracy: found.accuracy,
    })
}

/// An optimum with its verdict and all that is observed of it. Notes say why its grid is another one than that of the problem, and that inputs that hold
/// its goal were not found.
fn assessed(
    system: &System,
    control: &Control,
    optimum: Optimum,
    iterations: usize,
    (refined, not_found): (Option<String>, Option<String>),
) -> SolveResult {
    let (model, boundary) = (&optimum.model, &optimum.boundary);
    let tested = optimum.resimulation.as_ref();
    let not_kept = hold_check::warning(control, model, boundary, tested);
    let verdict = Verdict::from_optimum(control, &optimum, not_kept.as_deref());
    let discrete = discrete_trajectory(model, &optimum.motion);
    let trajectory = trajectory(model, &optimum.motion);
    let held = boundary.rest.each_ref().map(Option::as_deref);
    let [waypoint_values, final_values] = final_values(&optimum, control, (&trajectory, &discrete));
    let mut result = SolveResult {
        exchange: EnergyExchange::new(&model.system, &trajectory, held),
        tracking: followed(&optimum, control, &trajectory),
        waypoint_values,
        final_values,
        sensitivities: Vec::new(),
        gradients: None,
        outside: domain::records(&out_of_domain(model, &discrete)),
        remarks: Remarks::default(),
        optimum,
        iterations,
        accuracy: None,
        verdict,
        discrete,
        trajectory,
    };
    let not_kept = not_kept.filter(|_| result.verdict.is_solved);
    let can_seek = not_found.is_none() && hold_obstacle(&result.optimum.model, control).is_none();
    result.remarks = remarks(system, control, &result, (refined, not_kept, can_seek));
    result.remarks.note("hold", not_found);
    add_sensitivities(system, control, &mut result);
    result
}

/// Adds derivatives of an optimum, or the reason why there are none.
fn add_sensitivities(system: &System, control: &Control, result: &mut SolveResult) {
    if control.varied.is_empty() {
        return;
    }
    let (motion, outcomes) = (&result.optimum.motion, &control.outcomes);
    let found = match (result.optimum.meets_equations(), &outcomes[..]) {
        (false, _) => Err(NoSensitivity::Refused("no optimum was found".to_owned())),
        (true, []) => {
            let list = sensitivities(system, control, motion);
            list.map(|(list, refused)| {
                result.sensitivities = list;
                let one = |(name, reason)| format!("no sensitivity to {name}: {reason}");
                let texts = refused.into_iter().map(one);
                result.remarks.warn("no_sensitivities", texts);
            })
        }
        (true, outcomes) => {
            let found = gradients(system, control, motion, outcomes);
            found.map(|found| result.gradients = Some(found))
        }
    };
    if let Err(error) = found {
        let text = format!("no sensitivities: {error}");
        result.remarks.warn("no_sensitivities", [text]);
    }
}

/// All that is to be known of a result: `refined` is the reason for another grid than that of the problem, `not_kept` the reason why the end
/// is not kept, `can_seek` is true where inputs that hold the goal can be sought and were not.
fn remarks(
    system: &System,
    control: &Control,
    result: &SolveResult,
    (refined, not_kept, can_seek): (Option<String>, Option<String>, bool),
) -> Remarks {
    let optimum = &result.optimum;
    let tested = optimum.resimulation.as_ref();
    let afterwards = optimum.afterwards.as_ref();
    let left_goal = afterwards.and_then(|after| after.warning(can_seek));
    let mut remarks = Remarks::default();
    remarks.note("start", control.start.notes().iter().cloned());
    remarks.note("goal", optimum.boundary.notes.iter().cloned());
    remarks.note("moved_marker", moved_markers(system));
    remarks.warn("singular_loops", optimum.model.loops.warning.clone());
    remarks.note("refined_grid", refined);
    remarks.warn("coarse_intervals", tested.and_then(Resimulation::warning));
    let along = LoopLimits::of_optimum(control, optimum);
    remarks.warn("limit_passed", along.and_then(|along| along.warning()));
    remarks.warn("goal_not_held", not_kept.into_iter().chain(left_goal));
    let repeated = optimum.repeated.as_ref();
    remarks.warn("not_periodic", repeated.and_then(Repeated::warning));
    remarks.note("periodic", repeated.and_then(Repeated::note));
    remarks.warn("optimality_gap", optimum.program.wide.clone());
    remarks.note("free_end", free_end(control));
    if control.seeks_hold() && result.verdict.is_solved {
        let held = optimum.boundary.rest[1].as_deref();
        remarks.note(
            "hold",
            held.map(|held| hold_check::note_found(&optimum.model, held)),
        );
    }
    remarks.note("linear_solver", optimum.solution.linear.note());
    if is_unreached(&optimum.solution) {
        remarks.note("infeasible", explain(control, optimum));
    }
    remarks.note("earlier_solution", carried(&optimum.carried));
    remarks.note("second_start", optimum.restarted.map(restarted));
    remarks.warn("outside_domain", domain::note(&result.outside, true));
    let beyond = out_of_range(&optimum.model, &result.discrete);
    remarks.warn(
        "outside_range",
        domain::stretch_range_warning(&beyond, true),
    );
    remarks.note(
        "stops",
        infeasible::stop_notes(&optimum.model.system, &result.trajectory),
    );
    remarks.note("tracking", solve_messages::tracking_notes(&result.tracking));
    remarks.note("waypoint_value", ends(&result.waypoint_values));
    remarks.note("final_value", ends(&result.final_values));
    remarks
}
