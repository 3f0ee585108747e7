//! Motions solved as one program on their own grids, then on finer ones: until simulations reproduce them, until these confirm an accuracy, or
//! until an estimate of the error is small enough.
//!
//! The error of a grid falls with the square of its step: from the error e that a verification confirms on N intervals the next grid has
//! about N √(e/ε), and begins at the optimum before.

use crate::control::problem::{Control, ControlTask, Duration};
use crate::nlp::Status;
use crate::workflow::accuracy::{
    AccuracyTarget, Attempt, ErrorSample, OF_CONTROL, VARIABLES, refine,
};
use crate::workflow::attempt::Together;
use crate::workflow::error::WorkflowError;
use crate::workflow::motion::{Iterate, discrete_trajectory};
use crate::workflow::optimise::{is_infeasible, is_unreached, optimise_task};
use crate::workflow::optimum::{Budget, Optimum, SolveLimits};
use crate::workflow::reasons::Cause;
use std::ops::ControlFlow;

/// Deviation of the motion under the optimal voltages that is confirmed where no accuracy is set, as a part of the path length.
pub const ACCURACY: f64 = 0.01;
/// The part of the accuracy that the next grid is made for.
const AIMED: f64 = 0.7;
/// Least and greatest factor between the intervals of two grids, and that where the error is not known.
const FACTORS: [f64; 2] = [1.25, 4.0];
const UNKNOWN: f64 = 2.0;
/// Limit of grids.
const GRIDS: u32 = 7;
/// Doublings of the intervals of a motion that names them, where it is not reproduced.
const DOUBLINGS: u32 = 3;
/// Multiple of the intervals that is tried before a problem is called infeasible.
const FINER: usize = 2;
/// The solver's tolerance as a part of the accuracy asked for, where the problem names no smaller one.
const SOLVER: f64 = 1e-2;
/// Reasons why there are no motions on a finer grid.
const STOPPED: &str = "it was stopped";
const UNSOLVED: &str = "a finer grid was not solved";

/// Options of a solve in addition to its problem.
#[derive(Clone, Copy, Debug, Default)]
pub struct SolveRequest {
    /// Accuracy of the grid; nothing takes that of the problem.
    pub wanted: Option<AccuracyTarget>,
    /// Limits of the solver.
    pub limits: SolveLimits,
}

/// Solves for motions as one program, on their own grids.
///
/// Where an accuracy is wanted of motions that name their intervals, finer grids follow until every error is estimated below it, each with twice the
/// intervals of the one before. Else they follow for those whose verification does not confirm the accuracy (where their intervals are not given) or
/// fails, each time from the motions before. `observer` sees the number of all intervals and every iterate.
///
/// # Errors
/// As of [`optimise`](crate::workflow::optimise::optimise).
pub fn optimise_together(
    task: &ControlTask<'_>,
    request: SolveRequest,
    observer: &mut dyn FnMut(usize, &Iterate<'_>) -> ControlFlow<()>,
) -> Result<Together, WorkflowError> {
    let SolveRequest { wanted, limits } = request;
    let once = task.with_limits_once();
    let task = task.with(once.iter().map(|control| &**control));
    if let (Some(other), [_, ..]) = (task.other_grid(), task.shared_inputs) {
        let reason = format!(
            "the instants of the motion \"{}\" are other ones",
            other.name
        );
        return Err(WorkflowError::problem("control.shared_inputs", reason));
    }
    let are_given = task.motions.iter().all(|one| !one.control.is_refined);
    let mut solves = GridSolves {
        task: &task,
        are_given,
        tolerance: f64::INFINITY,
        budget: Budget::new(limits),
        observer,
        iterations: 0,
    };
    let accuracy = match wanted {
        Some(wanted) if are_given => return solves.estimated(wanted),
        Some(AccuracyTarget::Below(part)) => part,
        Some(AccuracyTarget::Estimate) | None => ACCURACY,
    };
    let mut found = solves.refined(accuracy)?;
    found.iterations = solves.iterations;
    Ok(found)
}

/// The solves so far.
struct GridSolves<'a, 'o> {
    task: &'a ControlTask<'a>,
    /// True if all motions name their intervals.
    are_given: bool,
    /// Greatest tolerance of the solver.
    tolerance: f64,
    budget: Budget,
    observer: &'o mut dyn FnMut(usize, &Iterate<'_>) -> ControlFlow<()>,
    /// Iterations of all of them.
    iterations: usize,
}

impl GridSolves<'_, '_> {
    /// Intervals of the motions times a factor.
    fn times(&self, factor: usize) -> Vec<usize> {
        let motions = self.task.motions.iter();
        motions.map(|one| factor * one.control.intervals).collect()
    }

    /// Solves on grids with these intervals, from earlier motions or from the guesses.
    fn solve(
        &mut self,
        intervals: &[usize],
        earlier: Option<&Together>,
    ) -> Result<Together, WorkflowError> {
        let motions = self.task.motions.iter().zip(intervals);
        let controls = motions.map(|(one, &intervals)| {
            let mut control = one.control.clone();
            control.intervals = intervals;
            control.solver.tolerance = control.solver.tolerance.min(self.tolerance);
            control
        });
        let controls: Vec<Control> = controls.collect();
        let limits = self.budget.left_of_limits();
        let mut task = self.task.with(&controls);
        for (k, motion) in task.motions.iter_mut().enumerate() {
            motion.earlier = earlier.map(|found| &found.optima[k].motion);
        }
        let intervals = intervals.iter().sum();
        let observer = &mut self.observer;
        let found = optimise_task(&task, limits, &mut |iterate| observer(intervals, iterate))?;
        self.iterations += iterations(&found);
        Ok(found)
    }

    /// Solves on the own grids, then on finer ones of the motions whose verification does not confirm the `accuracy` (where their intervals are not
    /// given) or fails; the finest stays. Where all intervals are given and no grid has motions that are reproduced, the first stays.
    fn refined(&mut self, accuracy: f64) -> Result<Together, WorkflowError> {
        let first = self.solve(&self.times(1), None)?;
        if let Some(found) = self.feasible(&first) {
            return Ok(found);
        }
        let count = first.optima.len();
        let (mut of_problems, mut tried, mut why) = (vec![None; count], None, None);
        let mut finest: Option<Together> = None;
        for grid in 1..GRIDS {
            let before = finest.as_ref().unwrap_or(&first);
            let finer = self.finer(&before.optima, accuracy, grid);
            let Some(intervals) = finer.filter(|_| before.meets_equations()) else {
                break;
            };
            let each = self.task.motions.iter().zip(&before.optima);
            for ((motion, old), note) in each.zip(&mut of_problems) {
                let cause = old.cause().filter(|_| !motion.control.is_refined);
                let n = old.motion.intervals();
                let told = || cause.map(|cause| format!("on {n} intervals: {}", cause.message()));
                *note = note.take().or_else(told);
            }
            match self.refine(before, &intervals) {
                Ok(next) => finest = Some(next),
                Err(UNSOLVED) if self.are_given => {}
                Err(reason) => {
                    why = Some(reason);
                    break;
                }
            }
            tried = Some(intervals);
        }
        let stays = |found: &Together| !self.are_given || found.is_solved();
        let mut found = finest.filter(stays).unwrap_or(first);
        let stopped = self.budget.stopped();
        let motions = self.task.motions.iter().zip(&mut found.optima);
        for (number, ((motion, optimum), of_problem)) in motions.zip(of_problems).enumerate() {
            // What the solver found, or what several motions did not reach, might have been tried again.
            let is_open = optimum.meets_equations() || count > 1 && is_unreached(&optimum.solution);
            if is_open && !optimum.is_solved() {
                optimum.stopped = stopped;
            }
            let is_short = motion.control.is_refined && !is_confirmed(optimum, accuracy);
            let n = optimum.motion.intervals();
            let finest = tried.as_ref().map(|all: &Vec<usize>| all[number]);
            optimum.refined = match of_problem {
                _ if is_short && optimum.meets_equations() => Some(unconfirmed(n, accuracy, why)),
                Some(_) if !optimum.is_solved() => finest.map(not_reproduced),
                of_problem => of_problem.map(|of_problem| reproduced_on(&of_problem, n)),
            };
        }
        Ok(found)
    }

    /// Motions with twice the intervals that are given, where the own ones leave none: they may not resolve the motion.
    fn feasible(&mut self, first: &Together) -> Option<Together> {
        let is_open = self.are_given && is_infeasible(first.optima[0].solution.status);
        if !is_open || self.budget.is_over() || FINER * first.whole.variables > VARIABLES {
            return None;
        }
        let found = self.solve(&self.times(FINER), None).ok();
        let mut found = found.filter(Together::is_solved)?;
        for optimum in &mut found.optima {
            let finer = optimum.motion.intervals();
            let own = finer / FINER;
            optimum.refined = Some(format!(
                "on {own} intervals no motion keeps goal and limits; on {finer} intervals this one does"
            ));
        }
        Some(found)
    }

    /// Solves on finer grids, from the motions before, then, unless their grids are merely coarse, from the guesses; the reason where that is not done.
    fn refine(&mut self, before: &Together, intervals: &[usize]) -> Result<Together, &'static str> {
        let grown = before.optima.iter().zip(intervals);
        let grown = grown.map(|(one, &n)| n as f64 / one.motion.intervals() as f64);
        let variables = before.whole.variables as f64 * grown.fold(1.0, f64::max);
        if self.budget.is_over() {
            return Err(STOPPED);
        }
        if variables > VARIABLES as f64 {
            return Err("a finer grid is too large");
        }
        let mut next: Option<Together> = None;
        let is_coarse = |one: &Optimum| matches!(one.cause(), None | Some(Cause::Coarse { .. }));
        for earlier in [Some(before), None] {
            let is_enough = |next: &Together| {
                !self.are_given || next.is_solved() || next.optima.iter().all(is_coarse)
            };
            if self.budget.is_over() || next.as_ref().is_some_and(is_enough) {
                break;
            }
            let found = self.solve(intervals, earlier).ok();
            next = found.filter(Together::meets_equations).or(next);
        }
        let mut next = next.ok_or_else(|| match self.budget.is_over() {
            true => STOPPED,
            false => UNSOLVED,
        })?;
        next.carry(before);
        Ok(next)
    }

    /// Intervals of the next grids, the first of which has number 1; none where each verification is passed, or no finer grid is tried. Where inputs are
    /// shared all grids stay equal.
    fn finer(&self, optima: &[Optimum], accuracy: f64, grid: u32) -> Option<Vec<usize>> {
        let each = self.task.motions.iter().zip(optima);
        let next = each.map(|(motion, optimum)| {
            let n = optimum.motion.intervals();
            match motion.control.is_refined {
                true if is_confirmed(optimum, accuracy) => n,
                true => (n as f64 * factor(optimum, accuracy)).ceil() as usize,
                false if optimum.is_solved() || grid > DOUBLINGS => n,
                false => motion.control.intervals << grid,
            }
        });
        let mut next: Vec<usize> = next.collect();
        if !self.task.shared_inputs.is_empty() {
            let most = next.iter().copied().max().unwrap_or(0);
            next.fill(most);
        }
        let mut each = next.iter().zip(optima);
        let is_finer = each.any(|(n, optimum)| *n > optimum.motion.intervals());
        is_finer.then_some(next)
    }

    /// Solves on the own grids, then on those with twice the intervals, until every error is estimated below what is wanted; or estimates the error on
    /// the own grids. Errors are the greatest of all motions, that of the objective is the one of all.
    fn estimated(&mut self, wanted: AccuracyTarget) -> Result<Together, WorkflowError> {
        if let AccuracyTarget::Below(error) = wanted {
            self.tolerance = SOLVER * error;
        }
        let budget = self.budget;
        let stop = || budget.stopped().map(Status::word);
        let refined = refine(wanted, OF_CONTROL, stop, |times, before| {
            let mut found = self.solve(&self.times(times), before)?;
            // What the guess of the problem became belongs to all grids.
            before.iter().for_each(|before| found.carry(before));
            Ok(self.compared(found))
        })?;
        let mut found = refined.run;
        for optimum in &mut found.optima {
            if optimum.meets_equations() && !optimum.is_solved() {
                optimum.stopped = self.budget.stopped();
            }
        }
        Ok(Together {
            iterations: refined.iterations,
            accuracy: Some(refined.accuracy),
            ..found
        })
    }

    /// A solve as one of the grids that are compared.
    fn compared(&self, run: Together) -> Attempt<Together> {
        // What is not reproduced may be on a finer grid.
        let is_complete = run.meets_equations();
        let open = run.optima.iter().find(|one| !one.is_solved());
        let motions = self.task.motions.iter().zip(&run.optima);
        let motions = motions.filter(|_| is_complete);
        let mut samples = motions.map(|(motion, optimum)| sample(optimum, motion.control));
        let first = samples.next().unwrap_or_default();
        Attempt {
            sample: ErrorSample {
                objective: is_complete.then(|| run.objective()),
                further: samples.collect(),
                ..first
            },
            intervals: run.optima.iter().map(|one| one.motion.intervals()).sum(),
            iterations: iterations(&run),
            variables: run.whole.variables,
            status: open.unwrap_or(&run.optima[0]).word(),
            is_complete,
            run,
        }
    }
}

/// Iterations of a solve.
fn iterations(found: &Together) -> usize {
    let solution = &found.optima[0].solution;
    solution.iterations.len().saturating_sub(1)
}

/// Note on an optimum of a finer grid, after the reason of it.
fn reproduced_on(of_problem: &str, intervals: usize) -> String {
    format!(
        "{of_problem}; solved again on {intervals} intervals; this optimum is reproduced by its inputs"
    )
}

/// Note on the lack of an optimum that is reproduced.
fn not_reproduced(intervals: usize) -> String {
    format!(
        "on finer grids of up to {intervals} intervals no optimum was reproduced by its inputs either"
    )
}

/// Note on an accuracy that is not confirmed, and why no finer grid was tried.
fn unconfirmed(intervals: usize, accuracy: f64, why: Option<&str>) -> String {
    format!(
        "the verification does not confirm an error below {} % of the path length on {intervals} intervals{}",
        100.0 * accuracy,
        why.map_or(String::new(), |why| format!(": {why}")),
    )
}

/// Returns true if the verification confirms an error of no more than this part of the path length.
fn is_confirmed(optimum: &Optimum, accuracy: f64) -> bool {
    let tested = optimum.resimulation.as_ref();
    tested.is_some_and(|tested| {
        let error = tested.error.unwrap_or(f64::INFINITY);
        tested.cause.is_none() && tested.is_confirmed && error <= accuracy
    })
}

/// Returns the factor of the intervals of the next grid.
fn factor(optimum: &Optimum, accuracy: f64) -> f64 {
    let tested = optimum.resimulation.as_ref();
    let error = tested.filter(|tested| tested.is_confirmed);
    let error = error.and_then(|tested| tested.error);
    error.map_or(UNKNOWN, |error| {
        let factor = (error / (AIMED * accuracy)).sqrt();
        factor.clamp(FACTORS[0], FACTORS[1])
    })
}

/// Returns the values of an optimum that are compared, without its objective.
fn sample(optimum: &Optimum, control: &Control) -> ErrorSample {
    let (model, kept) = (&optimum.model, &optimum.motion);
    let mut sample = ErrorSample::of_motion(model, &discrete_trajectory(model, kept));
    let is_free = matches!(control.duration, Duration::Free { .. });
    sample.duration = is_free.then(|| kept.times[kept.intervals()]);
    let tested = optimum.resimulation.as_ref();
    let half = tested.and_then(|tested| tested.half.as_ref());
    let half = half.map(|half| ErrorSample::of_motion(model, half));
    let response = half.map_or(f64::INFINITY, |half| sample.deviation(&half));
    sample.response = Some(response);
    sample
}
