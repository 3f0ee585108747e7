//! A task solved in memory: from its own guess, and a single motion from others where that leads nowhere.

use crate::control::Solution;
use crate::control::problem::{
    Control, ControlTask, Duration, Guess, MotionTask, Objective, Voltages,
};
use crate::dynamics::stable_equilibrium;
use crate::ipopt::SolverResult;
use crate::math::Signal;
use crate::model::{Model, Role, System};
use crate::nlp::Status;
use crate::stop;
use crate::workflow::attempt::Together;
use crate::workflow::error::WorkflowError;
use crate::workflow::motion::Iterate;
use crate::workflow::optimum::{Budget, Optimum, Restarted, Shortest, SolveLimits};
use crate::workflow::remark::phase;
use crate::workflow::solves::{put_after, put_before};
use crate::workflow::stages::attempt_by_stages;
use std::ops::ControlFlow;

/// Solves a control problem, from an `earlier` solution where one is given; from its guess, and from others where that leads nowhere;
/// `observer` sees every iterate.
///
/// # Errors
/// Start, goal, guess or an option of the solver is wrong. A problem without a solution is no error: see the status.
pub fn optimise(
    system: &System,
    control: &Control,
    earlier: Option<&Solution>,
    allowed: SolveLimits,
    observer: &mut dyn FnMut(&Iterate<'_>) -> ControlFlow<()>,
) -> Result<Optimum, WorkflowError> {
    let motion = MotionTask {
        earlier,
        ..MotionTask::alone(system, control)
    };
    let mut found = optimise_task(&motion.into(), allowed, observer)?;
    Ok(found.optima.remove(0))
}

/// Solves a task; where its own start leads nowhere a single motion from others too, and several from displaced guesses.
pub(super) fn optimise_task(
    task: &ControlTask<'_>,
    allowed: SolveLimits,
    observer: &mut dyn FnMut(&Iterate<'_>) -> ControlFlow<()>,
) -> Result<Together, WorkflowError> {
    let budget = Budget::new(allowed);
    let mut found = attempt_by_stages(task, allowed, observer)?;
    if !is_unreached(&found.optima[0].solution) {
        return Ok(found);
    }
    if let [motion] = task.motions[..] {
        let starts = SecondStarts {
            motion,
            budget,
            observer,
            found: found.optima.remove(0),
        };
        found.optima.push(starts.solve());
    } else if task.motions[0].earlier.is_none() && !budget.is_over() {
        phase("second, displaced initial guesses");
        let each = task.motions.iter().zip(&found.optima);
        let each = each.map(|(motion, first)| displaced(motion.control, first));
        let controls: Vec<Control> = each.collect();
        let second = attempt_by_stages(&task.with(&controls), budget.left_of_limits(), observer);
        let Ok(mut second) = second else {
            return Ok(found);
        };
        let is_better = second.meets_equations();
        for (new, old) in second.optima.iter_mut().zip(&mut found.optima) {
            match is_better {
                true => put_before(&mut new.solution, &old.solution),
                false => put_after(&mut old.solution, &new.solution),
            }
        }
        if is_better {
            return Ok(second);
        }
    }
    Ok(found)
}

/// Starts, in words.
const SHORTEST: &str = "the shortest motion";
const DISPLACED: &str = "a second, displaced initial guess";
const SLOW: &str = "a slow motion";

/// Other starts of a control problem whose first one led nowhere.
struct SecondStarts<'a, 'o> {
    motion: MotionTask<'a>,
    budget: Budget,
    observer: &'o mut dyn FnMut(&Iterate<'_>) -> ControlFlow<()>,
    /// The first solve, with the iterations of all, or that which has found a motion.
    found: Optimum,
}

impl SecondStarts<'_, '_> {
    /// Solves from the shortest motion, where that is as short as is asked for, and, unless it is longer, from a displaced guess; then looks for a motion as
    /// slow as the slowest mode. The first solve, where none leads anywhere.
    fn solve(mut self) -> Optimum {
        self.others();
        if !self.found.meets_equations() {
            self.advised();
        }
        if !self.found.meets_equations() {
            self.found.stopped = self.budget.stopped();
        }
        self.found
    }

    /// Solves from the shortest motion, and from a displaced guess.
    fn others(&mut self) {
        let MotionTask {
            control, earlier, ..
        } = self.motion;
        if self.budget.is_over() {
            return;
        }
        phase("looking for the shortest motion");
        let (said, motion) = self.shortest();
        self.found.shortest = said;
        if let (Some(motion), false) = (motion, self.budget.is_over()) {
            phase("solving from the shortest motion");
            self.replace(control, Some(&motion), SHORTEST);
        }
        let is_done = self.found.meets_equations() || matches!(said, Shortest::Longer(_));
        if !is_done && earlier.is_none() && !self.budget.is_over() {
            phase(DISPLACED);
            self.replace(&displaced(control, &self.found), None, DISPLACED);
        }
    }

    /// Looks for what the slowest mode says of a problem that no start solved, and solves from a slow motion that is as short as is asked for.
    fn advised(&mut self) {
        if self.budget.is_over() {
            return;
        }
        phase("looking for the slowest mode");
        let watch = stop::watch(self.budget.left());
        self.found.half_period = half_period(&self.found);
        drop(watch);
        if matches!(self.found.shortest, Shortest::Longer(_) | Shortest::AsGiven) {
            return;
        }
        phase("looking for a slow motion");
        let Some((said, motion)) = self.slow() else {
            return;
        };
        self.found.shortest = said;
        if let (Some(motion), false) = (motion, self.budget.is_over()) {
            self.replace(self.motion.control, Some(&motion), SLOW);
        }
    }

    /// Takes the optimum of another start, where that finds one; with the iterations of both.
    fn replace(&mut self, control: &Control, earlier: Option<&Solution>, from: &'static str) {
        let Some(mut second) = self.again(control, earlier, ITERATIONS, true) else {
            return;
        };
        let before = &mut self.found;
        if !second.meets_equations() {
            put_after(&mut before.solution, &second.solution);
            return;
        }
        let first = before.solution.status;
        put_before(&mut second.solution, &before.solution);
        *before = Optimum {
            setup: before.setup,
            carried: before.carried,
            restarted: Some(Restarted { first, from }),
            ..second
        };
    }

    /// Looks for the shortest motion that is no shorter than the one asked for, where that was not found: from the guess of the problem and from a displaced
    /// one. What it says, and the motion where that is as short as is asked for.
    fn shortest(&mut self) -> (Shortest, Option<Solution>) {
        let MotionTask {
            control, earlier, ..
        } = self.motion;
        let Duration::Given(given) = control.duration else {
            return (Shortest::Unknown, None);
        };
        let freed = freed(control, given);
        if !fits(&freed) {
            return (Shortest::Unknown, None);
        }
        let iterations = iterations(&self.found);
        let displaced = match earlier {
            None => Some((displaced(&freed, &self.found), None, ITERATIONS)),
            Some(_) => None,
        };
        let starts = [(freed, earlier, iterations)].into_iter().chain(displaced);
        let mut said = Shortest::Unknown;
        for (problem, earlier, iterations) in starts {
            let Some(found) = self.freed(&problem, earlier, iterations) else {
                break;
            };
            let motion;
            (said, motion) = read(found, given);
            if motion.is_some() || matches!(said, Shortest::Longer(_)) {
                return (said, motion);
            }
        }
        (said, None)
    }

    /// Looks for a motion that is about as slow as the slowest mode, where that is slower than what is asked for and no other start led anywhere.
    /// As of [`shortest`](Self::shortest); `None` if it finds none, too.
    fn slow(&mut self) -> Option<(Shortest, Option<Solution>)> {
        let control = self.motion.control;
        let Duration::Given(given) = control.duration else {
            return None;
        };
        let half_period = self.found.half_period.filter(|half| *half > given)?;
        let problem = slowed(control, &self.found.model, given, half_period);
        if !fits(&problem) {
            return None;
        }
        let (said, motion) = read(self.freed(&problem, None, ITERATIONS)?, given);
        let is_told = matches!(said, Shortest::AsGiven | Shortest::Longer(_));
        is_told.then_some((said, motion))
    }

    /// Solves a problem with a free duration; its iterations are put to those of the first solve. `None` if it is time to stop, or it cannot be stated.
    fn freed(
        &mut self,
        control: &Control,
        earlier: Option<&Solution>,
        iterations: usize,
    ) -> Option<Optimum> {
        if self.budget.is_over() {
            return None;
        }
        let found = self.again(control, earlier, iterations, false)?;
        put_after(&mut self.found.solution, &found.solution);
        Some(found)
    }

    /// Solves from another start, or another problem, within a number of iterations, which the observer sees where they are of the problem. `None` if it
    /// cannot be stated.
    fn again(
        &mut self,
        control: &Control,
        earlier: Option<&Solution>,
        iterations: usize,
        is_seen: bool,
    ) -> Option<Optimum> {
        let motion = MotionTask {
            control,
            earlier,
            ..self.motion
        };
        let limits = self.budget.left_within(iterations, self.motion.control);
        let observer = &mut |iterate: &Iterate<'_>| match is_seen {
            true => (self.observer)(iterate),
            false => ControlFlow::Continue(()),
        };
        let found = attempt_by_stages(&motion.into(), limits, observer).ok();
        found.map(|mut found| found.optima.remove(0))
    }
}

/// The outcome of a solve with a free duration, and its motion where that is as short as is asked for.
fn read(found: Optimum, given: f64) -> (Shortest, Option<Solution>) {
    let said = outcome(&found, given);
    let is_start = is_as_given(&found, given);
    (said, is_start.then_some(found.motion))
}

/// Half a period in ms of the slowest vibration about rest: at the goal, or where that is no state of rest, under the voltages of the start.
fn half_period(found: &Optimum) -> Option<f64> {
    let Optimum {
        model, boundary, ..
    } = found;
    let of_goal = boundary.goal.rest.as_ref();
    let period = of_goal.and_then(|rest| rest.slowest_period(model));
    let of_start = || {
        let none = vec![0.0; model.sources.len()];
        let voltages = boundary.rest[0].as_ref().unwrap_or(&none);
        let rest = stable_equilibrium(model, &boundary.start.z, &model.scalars(voltages));
        rest.ok()?.slowest_period(model)
    };
    period.or_else(of_start).map(|period| 0.5 * period)
}

/// Largest free duration and the first one, as multiples of the given one.
const LONGEST: f64 = 20.0;
const FIRST: f64 = 2.0;
/// Iterations of its solve, as a multiple of those of the first one, within these limits.
const TIMES: usize = 2;
const FEWEST: usize = 60;
const MOST: usize = 200;
/// A free duration that is longer by no more than this part lies on its lower bound.
const ON_BOUND: f64 = 1e-5;
/// Largest duration of a slow motion in halves of the period of the slowest mode.
const SLOWEST: f64 = 4.0;
/// Cost of inputs that cross their ranges evenly in half that period, as a part of the cost of this time: what is faster than the slowest mode
/// costs more than it saves, and the mode itself does not.
const SMOOTH: f64 = 0.5;

/// The problem whose duration is free and alone costs something.
fn freed(control: &Control, given: f64) -> Control {
    Control {
        duration: Duration::Free {
            min: given,
            max: LONGEST * given,
            guess: FIRST * given,
        },
        objective: Objective {
            duration: 1.0,
            ..Objective::default()
        },
        ..control.clone()
    }
}

/// Returns true if what the problem gives over time has derivatives by the duration, and its goal rests at all of them or at none.
fn fits(control: &Control) -> bool {
    let has_jump = |function: &Signal| control.duration.jump(function).is_some();
    let changes = |function: &Signal| control.duration.final_value(function).is_none();
    let rests = control.goal.voltages().is_some();
    let is_sampled = control
        .course
        .as_ref()
        .is_some_and(|course| course.table.is_some());
    let mut functions = control.given.values();
    !is_sampled && !functions.any(|function| has_jump(function) || (rests && changes(function)))
}

/// The same from half a period of the slowest mode on, with inputs that change slowly.
fn slowed(control: &Control, model: &Model, given: f64, half_period: f64) -> Control {
    let seconds = half_period / 1e3;
    let ranges = squared_ranges(control, model);
    let rate = SMOOTH * seconds * seconds / ranges;
    let freed = freed(control, given);
    Control {
        duration: Duration::Free {
            min: given,
            max: f64::max(LONGEST * given, SLOWEST * half_period),
            guess: half_period,
        },
        objective: Objective {
            rate: if rate.is_finite() { rate } else { 0.0 },
            ..freed.objective
        },
        ..freed
    }
}

/// Sum of the squared ranges of the inputs that are sought, in the units in which objectives count them; of unbounded ones their sizes.
fn squared_ranges(control: &Control, model: &Model) -> f64 {
    let inputs = [Role::Voltage, Role::Load].into_iter();
    let inputs = inputs.flat_map(|role| model.variables.with(role));
    let sought = inputs.filter(|input| !input.source.is_some_and(|s| control.is_given(s)));
    let ranges = sought.map(|input| {
        let [low, high] = control.bounds(input);
        let range = match (high - low).is_finite() {
            true => high - low,
            false => control.size(input, model),
        };
        let kind = model.input_kind(input.source.expect("an input of a source"));
        (range / kind.counted().1).powi(2)
    });
    ranges.sum()
}

/// Iterations of a solve for the shortest motion.
fn iterations(first: &Optimum) -> usize {
    (TIMES * first.solution.iterations.len()).clamp(FEWEST, MOST)
}

/// Returns true if a solve with a free duration ends at the given one.
fn is_as_given(found: &Optimum, given: f64) -> bool {
    let duration = found.motion.times[found.motion.intervals()];
    found.solution.status == Status::Solved && duration <= given * (1.0 + ON_BOUND)
}

/// Reads the end of a solve with a free duration for a given one. What its voltages do not reproduce is no advice.
fn outcome(found: &Optimum, given: f64) -> Shortest {
    match found.solution.status {
        Status::Solved if !found.is_solved() => Shortest::Unknown,
        Status::Solved if is_as_given(found, given) => Shortest::AsGiven,
        Status::Solved => Shortest::Longer(found.motion.times[found.motion.intervals()]),
        status if is_infeasible(status) => Shortest::NotUpTo(LONGEST * given),
        _ => Shortest::Unknown,
    }
}

/// Iterations of the second start; an optimum is found from it soon or not at all.
const ITERATIONS: usize = 100;

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
fn displaced(control: &Control, first: &Optimum) -> Control {
    let [low, high] = control.voltage_bounds;
    let guess = match (&control.guess, &first.boundary.rest[1]) {
        (Guess::Simulate(_), _) => Guess::Interpolate,
        (_, Some(hold)) => Guess::Simulate(Voltages::constant(hold)),
        (_, None) => {
            // Without bounds nothing is known of the size of voltages.
            let half = 0.5 * (low + high);
            let half = if half.is_finite() { half } else { 0.0 };
            let sources = first.model.sources.iter();
            let row = sources.map(|source| if source.is_load() { 0.0 } else { half });
            Guess::Simulate(Voltages::constant(&row.collect::<Vec<_>>()))
        }
    };
    Control {
        guess,
        ..control.clone()
    }
}
