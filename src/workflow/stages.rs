//! A solve by stages of contacts: those of the first stage act at a distance, are soft and have slow friction, and those of the last are the
//! scene's. Each stage begins where the one before ended.
//!
//! A contact that is open along the whole guess has neither a force nor a derivative, so that the solver does not see it; a stiff or rough one
//! bends the equations within a step of the solver. Each constant q of a contact is `q₀ᵗ q¹⁻ᵗ` between that of the first stage, at t = 1, and
//! that of the scene, at t = 0. Where the first stage is not solved the widths grow; a later one that is not solved halves the way to it; and
//! where both lead nowhere simulations look for a start. An earlier solution, or a guess of the user's, shows the solver which contacts close: it
//! begins at t = 0, and at a greater t where that is not solved.

use crate::control::Transcription;
use crate::control::problem::{Control, ControlTask, Guess, MotionTask};
use crate::dynamics::{DiscreteTrajectory, least_gaps};
use crate::ipopt::SolverResult;
use crate::model::components::{Component, Contact, SoftContact};
use crate::model::{Model, System};
use crate::workflow::attempt::{Together, attempt};
use crate::workflow::error::WorkflowError;
use crate::workflow::motion::Iterate;
use crate::workflow::optimum::{Budget, Optimum, SolveLimits, Stages};
use crate::workflow::program::{Prepared, prepare_together, program_motions, resolve_each};
use crate::workflow::reasons::Cause;
use crate::workflow::remark::phase;
use crate::workflow::resimulate::Verification;
use crate::workflow::search::simulated_start;
use crate::workflow::solves::put_before;
use std::f64::consts::PI;
use std::ops::ControlFlow;

/// Width over which the stiffness of an open contact grows at t = 1, in least gaps along the guess.
const WIDTH: f64 = 3.0;
/// Intervals of a touch, which give the stiffness, at t = 1.
const TOUCH: f64 = 4.0;
/// Speed of slip at t = 1, in lengths of the system over the duration.
const SLIP: f64 = 0.5;
/// Elastic displacement of friction that sticks at t = 1, in lengths of the system.
const STICK: f64 = 0.2;
/// First step of t, its growth after a stage that is solved, and the one from which on it is not halved.
const STEP: f64 = 1.0 / 3.0;
const GROWTH: f64 = 1.5;
const LEAST: f64 = 1.0 / 48.0;
/// Step of t beyond 1 as long as no stage is solved, and the greatest t.
const FARTHER: f64 = 0.5;
const FARTHEST: f64 = 2.0;
/// Iterations of a stage, and its tolerance before the last one.
const ITERATIONS: usize = 150;
const TOLERANCE: f64 = 1e-4;

/// Solves a task from one start as [`attempt`], by stages where contacts call for them.
///
/// # Errors
/// As of [`attempt`].
pub(super) fn attempt_by_stages(
    task: &ControlTask<'_>,
    allowed: SolveLimits,
    observer: &mut dyn FnMut(&Iterate<'_>) -> ControlFlow<()>,
) -> Result<Together, WorkflowError> {
    let first = first_contacts(task)?;
    if first.iter().all(Vec::is_empty) {
        return attempt(task, allowed, Verification::Full, observer);
    }
    let mut way = Way {
        task,
        simulated: None,
        first,
        budget: Budget::new(allowed),
        observer,
        reached: None,
        before: Vec::new(),
        solved: 0,
        stopped: None,
    };
    way.follow()
}

/// The way from the first contacts to those of the scene.
struct Way<'a, 'o> {
    task: &'a ControlTask<'a>,
    /// The problem of a single motion with a guess that simulations found.
    simulated: Option<Control>,
    /// The contacts of each motion at t = 1; none of a motion that needs no softer ones.
    first: Vec<Vec<SoftContact>>,
    budget: Budget,
    observer: &'o mut dyn FnMut(&Iterate<'_>) -> ControlFlow<()>,
    /// The last stage that was solved.
    reached: Option<Together>,
    /// Result of the last solve for each motion, with the iterations of all before it.
    before: Vec<SolverResult>,
    /// Number of stages that were solved.
    solved: usize,
    /// The last iterate of a solve that was stopped.
    stopped: Option<Together>,
}

impl Way<'_, '_> {
    /// Solves by stages from the guess of the problem; from one that simulations find where these lead nowhere; and at once where those do, too.
    fn follow(&mut self) -> Result<Together, WorkflowError> {
        if let Some(found) = self.stages() {
            return Ok(found);
        }
        if self.stopped.is_none() {
            self.simulated = simulated_start(self.task, &self.budget)?;
        }
        if self.simulated.is_some() {
            (self.reached, self.solved) = (None, 0);
            if let Some(found) = self.stages() {
                return Ok(found);
            }
        }
        match self.stopped.take() {
            Some(stopped) => Ok(stopped),
            None => self.solve(0.0, usize::MAX),
        }
    }

    /// Solves stage after stage; the last one, unless they lead nowhere.
    fn stages(&mut self) -> Option<Together> {
        let is_shown = |motion: &MotionTask<'_>| {
            motion.earlier.is_some() || motion.control.guess != Guess::Interpolate
        };
        let first = match self.task.motions.iter().all(is_shown) {
            true => 0.0,
            false => 1.0,
        };
        let (mut at, mut next, mut step) = (None, first, STEP);
        while !self.budget.is_over() {
            phase("solving with softer contacts");
            let found = self.solve(next, ITERATIONS).ok();
            let is_solved = |found: &Together| found.optima.iter().all(is_motion);
            tracing::info!(
                t = next,
                is_solved = found.as_ref().is_some_and(is_solved),
                "stage"
            );
            let found = match found {
                Some(found) if is_solved(&found) => Some(found),
                stopped => {
                    self.stopped = stopped.filter(|_| self.budget.is_over());
                    None
                }
            };
            match (found, at) {
                (Some(found), _) if next == 0.0 => return Some(found),
                (Some(found), before) => {
                    self.reached = Some(found);
                    self.solved += 1;
                    step *= before.map_or(1.0, |_: f64| GROWTH);
                    at = Some(next);
                    next = f64::max(next - step, 0.0);
                }
                (None, None) if next < FARTHEST => next += FARTHER,
                (None, Some(at)) if at - next > LEAST => {
                    step = 0.5 * (at - next);
                    next = at - step;
                }
                (None, _) => break,
            }
        }
        None
    }

    /// Solves with the contacts at t, from the last stage that was solved.
    fn solve(&mut self, t: f64, iterations: usize) -> Result<Together, WorkflowError> {
        let each = self.task.motions.iter().zip(&self.first);
        let problems: Vec<(System, Control)> = each
            .map(|(motion, first)| {
                let control = self.simulated.as_ref().unwrap_or(motion.control);
                let (mut system, mut control) = (motion.system.clone(), control.clone());
                if t > 0.0 {
                    let contacts = system.components.contacts.iter_mut();
                    let pairs = contacts.zip(first);
                    pairs.for_each(|(contact, first)| *contact = contact.softened(first, t));
                    control.solver.tolerance = control.solver.tolerance.max(TOLERANCE);
                }
                (system, control)
            })
            .collect();
        let each = self.task.motions.iter().zip(&problems).enumerate();
        let motions = each.map(|(k, (motion, (system, control)))| MotionTask {
            system,
            control,
            earlier: match &self.reached {
                Some(found) => Some(&found.optima[k].motion),
                None => motion.earlier,
            },
            ..*motion
        });
        let task = ControlTask {
            motions: motions.collect(),
            ..*self.task
        };
        let limits = self.budget.left_within(iterations, task.motions[0].control);
        let verification = match t > 0.0 {
            true => Verification::OwnSteps,
            false => Verification::Full,
        };
        let mut found = attempt(&task, limits, verification, self.observer)?;
        for (number, optimum) in found.optima.iter_mut().enumerate() {
            let before = self.before.get(number);
            before
                .iter()
                .for_each(|before| put_before(&mut optimum.solution, before));
            optimum.stages = Stages {
                solved: self.solved,
                is_simulated: self.simulated.is_some(),
                is_softer: t > 0.0,
            };
        }
        let results = found.optima.iter().map(|one| one.solution.clone());
        self.before = results.collect();
        Ok(found)
    }
}

/// Returns true if an optimum is a motion of its system, resolved or not: a solver may find roots of the equations that are none.
fn is_motion(optimum: &Optimum) -> bool {
    let is_motion = matches!(optimum.cause(), None | Some(Cause::Coarse { .. }));
    optimum.meets_equations() && is_motion
}

/// The contacts of each motion at t = 1; none where those of the scene are no stiffer.
fn first_contacts(task: &ControlTask<'_>) -> Result<Vec<Vec<SoftContact>>, WorkflowError> {
    let touches = |motion: &MotionTask<'_>| !motion.system.components.contacts.is_empty();
    if !task.motions.iter().any(touches) {
        return Ok(Vec::new());
    }
    let resolved = resolve_each(task)?;
    let motions = program_motions(task, &resolved);
    let Prepared { program, point, .. } = prepare_together(&motions, task)?;
    let (places, parts) = (program.places(), program.parts());
    let each = motions.iter().zip(parts).enumerate();
    let first = each.map(
        |(number, (motion, part)): (usize, (_, &Transcription<'_>))| {
            let guess = part.decode(&places.values_of(number, &point.x));
            of_motion(motion.model, &motion.task, &guess)
        },
    );
    Ok(first.collect())
}

/// The contacts of a motion at t = 1; none where those of the scene are no stiffer.
fn of_motion(model: &Model, task: &MotionTask<'_>, guess: &DiscreteTrajectory) -> Vec<SoftContact> {
    let MotionTask {
        system, control, ..
    } = *task;
    let duration = control.duration.first();
    let touch = TOUCH * duration / control.intervals as f64;
    let length = model.length();
    let slip_speed = SLIP * length / duration;
    let gaps = least_gaps(model, guess);
    let first = |contact: &Contact| {
        let gap = gaps.iter().find(|(name, _)| *name == contact.name);
        let gap = gap.map_or(0.0, |(_, gap)| gap.max(0.0));
        let inverse = |body: Option<usize>| body.map_or(0.0, |b| system.bodies[b].mass.recip());
        let inverses: f64 = contact.points().iter().map(|end| inverse(end.body)).sum();
        // A touch of two masses lasts half a period.
        let stiffness = (PI / touch).powi(2) / inverses;
        contact.soft(WIDTH * gap, stiffness, slip_speed, STICK * length)
    };
    let contacts = &system.components.contacts;
    let first: Vec<SoftContact> = contacts.iter().map(first).collect();
    let mut pairs = contacts.iter().zip(&first);
    match pairs.any(|(own, first)| own.softened(first, 1.0) != *own) {
        true => first,
        false => Vec::new(),
    }
}
