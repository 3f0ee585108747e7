//! Control problems: solved, verified by simulations, and held after their end; of several motions together too.

use crate::control::problem::{Control, ControlTask, Guess, MotionTask, SoughtHold};
use crate::control::{Earlier, hold_obstacle};
use crate::dynamics::trajectory::Trajectory;
use crate::dynamics::{
    DiscreteTrajectory, EnergyExchange, out_of_domain, out_of_range, short_touches, wrinkles,
};
use crate::model::System;
use crate::sensitivity::{self, Gradients, NoSensitivity, Sensitivity, gradients, sensitivities};
use crate::tasks::check::moved_markers;
use crate::tasks::solve_messages::{self, Verdict, carried, ends, restarted};
use crate::workflow::accuracy::Accuracy;
use crate::workflow::closed_loop::LoopLimits;
use crate::workflow::hold_check::{self, Repeated, free_end};
use crate::workflow::infeasible::explain;
use crate::workflow::memory::{self, Occasion};
use crate::workflow::motion::{discrete_trajectory, trajectory};
use crate::workflow::optimise::is_unreached;
use crate::workflow::optimum::{Budget, Optimum};
use crate::workflow::remark::{Remarks, STOPPED_EARLY};
use crate::workflow::resimulate::Resimulation;
use crate::workflow::tracking::{FinalValue, Tracked, final_values, followed};
use crate::workflow::warnings::{self, Outside};
use crate::workflow::{
    Iterate, SolveRequest, Together, WholeProgram, WorkflowError, infeasible, optimise_together,
};
use std::borrow::Cow;
use std::ops::ControlFlow;

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
    let mut all = solve_motions(&task, request, observer)?;
    Ok(all.list.remove(0))
}

/// Solves for motions as one program, of which a single one is a case; each is verified, refined and held as one by itself. `observer` sees the number
/// of all intervals and every iterate.
///
/// # Errors
/// As of [`solve`].
pub fn solve_motions(
    task: &ControlTask<'_>,
    request: SolveRequest,
    observer: &mut dyn FnMut(usize, &Iterate<'_>) -> ControlFlow<()>,
) -> Result<MotionsResult, WorkflowError> {
    for motion in &task.motions {
        memory::of_elements(motion.system, Occasion::Factors)?;
    }
    if let [one] = &task.motions[..] {
        sensitivity::check(one.system, one.control).map_err(|(name, reason)| {
            WorkflowError::problem(format!("control.sensitivity.{name}"), reason)
        })?;
    }
    let (found, controls) = solve_and_hold(task, request, observer)?;
    let each = task.motions.iter().zip(&controls).zip(found.optima);
    let iterations = found.iterations;
    let list = each
        .map(|((motion, control), optimum)| assessed(motion.system, control, optimum, iterations));
    let mut list: Vec<SolveResult> = list.collect();
    let whole = found.whole;
    let mut remarks = Remarks::default();
    remarks.warn("optimality_gap", whole.wide.clone());
    let mut each = list.iter();
    let cut_short = each.find_map(|one| one.optimum.cut_short);
    let cut_short = cut_short.map(solve_messages::cut_short);
    remarks.warn(STOPPED_EARLY, cut_short.clone());
    remarks.warn("shared_inputs", held_apart(task, &list));
    // What is known of all of them is known of one that is alone.
    for result in list.iter_mut().filter(|_| task.motions[0].is_alone()) {
        result.accuracy.clone_from(&found.accuracy);
        result.remarks.warn(STOPPED_EARLY, cut_short.clone());
    }
    Ok(MotionsResult {
        verdict: verdict(task, &list),
        list,
        whole,
        iterations: found.iterations,
        accuracy: found.accuracy,
        remarks,
    })
}

/// An optimum with its verdict and all that is observed of it.
fn assessed(
    system: &System,
    control: &Control,
    optimum: Optimum,
    iterations: usize,
) -> SolveResult {
    let (model, boundary) = (&optimum.model, &optimum.boundary);
    let tested = optimum.resimulation.as_ref();
    let not_kept = hold_check::warning(control, model, boundary, tested);
    let verdict = Verdict::from_optimum(control, &optimum, not_kept.as_deref());
    let discrete = discrete_trajectory(model, &optimum.motion);
    let trajectory = trajectory(model, &optimum.motion);
    let held = boundary.rest.each_ref().map(Option::as_deref);
    let [waypoint_values, final_values] = final_values(&optimum, control, &trajectory, &discrete);
    let mut result = SolveResult {
        exchange: EnergyExchange::new(&model.system, &trajectory, held),
        tracking: followed(&optimum, control, &trajectory),
        waypoint_values,
        final_values,
        sensitivities: Vec::new(),
        gradients: None,
        outside: warnings::outside_domain(&out_of_domain(model, &discrete)),
        remarks: Remarks::default(),
        optimum,
        iterations,
        accuracy: None,
        verdict,
        discrete,
        trajectory,
    };
    let not_kept = not_kept.filter(|_| result.verdict.is_solved);
    result.remarks = remarks(system, control, &result, not_kept);
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
        (false, _) => Err(NoSensitivity::refused("no optimum was found")),
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

/// All that is to be known of a result, whose end is not kept for a reason, if any.
fn remarks(
    system: &System,
    control: &Control,
    result: &SolveResult,
    not_kept: Option<String>,
) -> Remarks {
    let optimum = &result.optimum;
    let tested = optimum.resimulation.as_ref();
    let can_seek = optimum.not_found.is_none() && hold_obstacle(&optimum.model, control).is_none();
    let afterwards = optimum.afterwards.as_ref();
    let left_goal = afterwards.and_then(|after| after.warning(can_seek));
    let mut remarks = Remarks::default();
    remarks.note("start", control.start.notes().iter().cloned());
    remarks.note("goal", optimum.boundary.notes.iter().cloned());
    remarks.note("moved_marker", moved_markers(system));
    remarks.warn("singular_loops", optimum.model.loops.warning.clone());
    remarks.note("refined_grid", optimum.refined.clone());
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
        let found = held.map(|held| hold_check::note_found(&optimum.model, held));
        remarks.note("hold", found);
    }
    remarks.note("linear_solver", optimum.solution.linear.note());
    if is_unreached(&optimum.solution) && control.continues == [false; 2] {
        remarks.note("infeasible", explain(control, optimum));
    }
    remarks.note("earlier_solution", carried(&optimum.carried));
    remarks.note("second_start", optimum.restarted.map(restarted));
    remarks.note("contact_stages", solve_messages::stages(optimum));
    let outside = warnings::domain_note(&result.outside, true);
    remarks.warn("outside_domain", outside);
    let wrinkles = wrinkles(&optimum.model, &result.discrete);
    remarks.warn("wrinkles", warnings::wrinkle_warning(&wrinkles, true));
    let beyond = out_of_range(&optimum.model, &result.discrete);
    let beyond = warnings::stretch_range_warning(&beyond, true);
    remarks.warn("outside_range", beyond);
    let short = short_touches(&optimum.model, &result.discrete);
    remarks.warn("coarse_touches", warnings::short_touch_warning(&short));
    let stops = infeasible::stop_notes(&optimum.model.system, &result.trajectory);
    remarks.note("stops", stops);
    remarks.note("tracking", solve_messages::tracking_notes(&result.tracking));
    remarks.note("waypoint_value", ends(&result.waypoint_values));
    remarks.note("final_value", ends(&result.final_values));
    remarks.note("hold", optimum.not_found.map(str::to_owned));
    remarks
}

/// Notes that no inputs that hold a goal were found, and that there was no time for it.
const NOT_FOUND: &str = "no inputs within the bounds were found that hold the goal";
const UNFINISHED: &str = "the inputs that hold the goal were not found in the time: \"hold\": \"find\" seeks them at once";

/// Solves a task, and again with the inputs that hold the goals as unknowns where these are left and can be held; those optima count if
/// simulations stay at the goals. With the optima come the problems that they solve.
///
/// # Errors
/// As of [`optimise_together`].
fn solve_and_hold<'a>(
    task: &ControlTask<'a>,
    request: SolveRequest,
    observer: &mut dyn FnMut(usize, &Iterate<'_>) -> ControlFlow<()>,
) -> Result<(Together, Vec<Cow<'a, Control>>), WorkflowError> {
    let budget = Budget::new(request.limits);
    let mut found = optimise_together(task, request, observer)?;
    hold(&mut found, task);
    let each = task.motions.iter().zip(&found.optima);
    let left = each.map(|(motion, optimum)| is_left(optimum, motion.control));
    let left: Vec<bool> = left.collect();
    if left.contains(&true) && !budget.is_over() {
        let each = task.motions.iter().zip(&found.optima).zip(&left);
        let held = each.map(|((motion, optimum), is_left)| held(motion.control, optimum, *is_left));
        let held: Vec<Control> = held.collect();
        let limits = budget.left_of_limits();
        let again = task.with(&held);
        match optimise_together(&again, SolveRequest { limits, ..request }, observer) {
            Ok(mut second) => {
                hold(&mut second, &again);
                second.iterations += found.iterations;
                let mut each = held.iter().zip(&second.optima).zip(&left);
                if each.all(|((control, optimum), is_left)| {
                    optimum.is_solved() && (!is_left || is_kept(optimum, control))
                }) {
                    second.carry(&found);
                    return Ok((second, held.into_iter().map(Cow::Owned).collect()));
                }
                found.iterations = second.iterations;
            }
            Err(error) => tracing::debug!(%error, "the inputs that hold the goals are not sought"),
        }
    }
    let each = found.optima.iter_mut().zip(left);
    for (optimum, _) in each.filter(|(_, is_left)| *is_left) {
        optimum.not_found = Some(NOT_FOUND);
        if budget.is_over() {
            optimum.not_found = Some(UNFINISHED);
            // By Ctrl-C the whole solve was stopped.
            optimum.stopped = optimum.stopped.or(Budget::of_seconds(None).stopped());
        }
    }
    let controls = task.motions.iter().map(|one| Cow::Borrowed(one.control));
    Ok((found, controls.collect()))
}

/// Holds the voltages of the goals after the ends.
fn hold(found: &mut Together, task: &ControlTask<'_>) {
    let each = found.optima.iter_mut().zip(&task.motions);
    each.for_each(|(optimum, motion)| optimum.hold(motion.control));
}

/// The problem from an optimum of it, in which inputs that hold its goal are unknowns where they `are_sought`.
fn held(control: &Control, optimum: &Optimum, are_sought: bool) -> Control {
    Control {
        sought_hold: match are_sought {
            true => SoughtHold::Always,
            false => control.sought_hold,
        },
        guess: Guess::Solution(Earlier::new(optimum.motion.clone())),
        ..control.clone()
    }
}

/// Returns true if an optimum leaves a goal for which inputs that hold it may be sought.
fn is_left(optimum: &Optimum, control: &Control) -> bool {
    let afterwards = optimum.afterwards.as_ref();
    control.sought_hold == SoughtHold::WhereLeft
        && afterwards.is_some_and(|after| !after.is_held)
        && hold_obstacle(&optimum.model, control).is_none()
}

/// Returns true if an optimum is reproduced and its goal is kept.
fn is_kept(optimum: &Optimum, control: &Control) -> bool {
    let tested = optimum.resimulation.as_ref();
    optimum.is_solved()
        && hold_check::warning(control, &optimum.model, &optimum.boundary, tested).is_none()
}

/// Motions that were optimised together.
#[derive(Debug)]
pub struct MotionsResult {
    /// Each as the result of a problem of its own.
    pub list: Vec<SolveResult>,
    /// All of them as one program.
    pub whole: WholeProgram,
    /// Iterations on all grids.
    pub iterations: usize,
    /// Estimated errors, the greatest of all motions, where an accuracy was wanted of motions that name their intervals.
    pub accuracy: Option<Accuracy>,
    /// The verdict on all of them: solved where each is.
    pub verdict: Verdict,
    /// Warnings and notes on all of them.
    pub remarks: Remarks,
}

/// Inputs that differ by less, relative to the largest, are the same.
const SAME: f64 = 1e-6;

/// That inputs which are the same in all motions are different ones after the end, where goals are held.
fn held_apart(task: &ControlTask<'_>, list: &[SolveResult]) -> Option<String> {
    let apart = task.shared_inputs.iter().filter(|name| {
        let each = task.motions.iter().zip(list);
        let held = each.filter_map(|(motion, result)| {
            let sources = motion.system.sources();
            let source = sources.iter().position(|source| source.name == **name)?;
            result.optimum.motion.hold.as_ref()?.get(source).copied()
        });
        let held: Vec<f64> = held.collect();
        let largest = held.iter().fold(0.0_f64, |a, b| a.max(b.abs()));
        let differ = |value: &f64| (value - held[0]).abs() > SAME * largest;
        held.iter().any(differ)
    });
    let apart: Vec<&str> = apart.map(String::as_str).collect();
    (!apart.is_empty()).then(|| {
        format!(
            "the inputs of {} are the same in all motions up to the end; after it each motion is held by other ones, which one history cannot be",
            apart.join(", ")
        )
    })
}

/// The verdict on all: the word of the first that is not solved, or not to the whole tolerance, and the reasons of all of these.
fn verdict(task: &ControlTask<'_>, list: &[SolveResult]) -> Verdict {
    let verdicts = || list.iter().map(|result| &result.verdict);
    let first = verdicts().find(|verdict| !verdict.is_solved);
    let weaker = verdicts().find(|verdict| verdict.word != "solved");
    let messages: Vec<&String> = verdicts()
        .filter_map(|verdict| verdict.message.as_ref())
        .collect();
    let are_one = messages.len() == list.len() && messages.windows(2).all(|two| two[0] == two[1]);
    let message = match &messages[..] {
        [] => None,
        [one, ..] if are_one => Some((*one).clone()),
        _ => {
            let named = task.motions.iter().zip(verdicts());
            let named = named.filter_map(|(motion, verdict)| {
                let message = verdict.message.as_ref()?;
                Some(format!("motion \"{}\": {message}", motion.name))
            });
            Some(named.collect::<Vec<_>>().join("; "))
        }
    };
    Verdict {
        word: first.or(weaker).map_or("solved", |verdict| verdict.word),
        is_solved: first.is_none(),
        message,
    }
}
