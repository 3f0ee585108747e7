//! Several motions optimised together, each on its own grid, and on finer ones until the verification of each is passed.

use std::ops::ControlFlow;
use std::time::Instant;

use crate::control::problem::Control;
use crate::control::{Motions, Solution};
use crate::nlp::Status;
use crate::workflow::attempt::{FoundTogether, WholeProgram, attempt_together};
use crate::workflow::error::WorkflowError;
use crate::workflow::grids::VARIABLES;
use crate::workflow::motion::Iterate;
use crate::workflow::optimum::{Optimum, SolveLimits, seconds_left};
use crate::workflow::prepare_together::MotionAsked;
use crate::workflow::remark::phase;
use crate::workflow::restarts::{displaced, is_unreached, stopped};
use crate::workflow::verified::{GRIDS, factor, is_confirmed, unconfirmed};

/// Greatest multiple of the intervals of a motion that names them.
const MOST_TIMES: usize = 8;

/// The reason why no finer grid was tried, where time was up.
const STOPPED: &str = "it was stopped";

/// Motions that were optimised together.
#[derive(Debug)]
pub struct Together {
    /// Each with its part of the result of the solver.
    pub optima: Vec<Optimum>,
    /// All of them as one program.
    pub whole: WholeProgram,
    /// Iterations on all grids.
    pub iterations: usize,
    /// For each a note on the reason for another grid, or on the lack of a verification.
    pub notes: Vec<Option<String>>,
}

/// Solves for several motions as one program, on their own grids; then on finer grids of those whose verification does not confirm the
/// `accuracy` (where their intervals are not given) or fails, each time from the motions before. `observer` sees the number of all intervals and every
/// iterate.
///
/// # Errors
/// As of [`optimise`](crate::workflow::optimise::optimise).
pub fn optimise_together(
    motions: &Motions,
    accuracy: f64,
    allowed: SolveLimits,
    observer: &mut dyn FnMut(usize, &Iterate<'_>) -> ControlFlow<()>,
) -> Result<Together, WorkflowError> {
    let motions = &motions.with_limits_once();
    let mut solves = Solves::new(motions, allowed, observer)?;
    let controls: Vec<Control> = motions.list.iter().map(|one| one.control.clone()).collect();
    let found = solves.first(&controls)?;
    let mut best = OnGrids {
        notes: vec![None; controls.len()],
        controls,
        found,
    };
    let mut why = None;
    for _ in 1..GRIDS {
        let finer = solves.finer(&best.controls, &best.found.optima, accuracy);
        let Some(intervals) = finer.filter(|_| best.found.meets_equations()) else {
            break;
        };
        match solves.refine(&best, &intervals) {
            Ok(finer) => best = finer,
            Err(reason) => {
                why = Some(reason);
                break;
            }
        }
    }
    let notes = best.end(accuracy, why, solves.stopped());
    Ok(Together {
        optima: best.found.optima,
        whole: best.found.whole,
        iterations: solves.iterations,
        notes,
    })
}

/// Motions found on grids: the problems with these grids, and why those of the problems did not do.
struct OnGrids {
    controls: Vec<Control>,
    found: FoundTogether,
    notes: Vec<Option<String>>,
}

impl OnGrids {
    /// Tells those that are not verified why no finer grid was tried; the notes on all.
    fn end(
        &mut self,
        accuracy: f64,
        why: Option<&str>,
        stopped: Option<Status>,
    ) -> Vec<Option<String>> {
        let each = self.found.optima.iter_mut().zip(&self.controls);
        let ended = each.zip(&mut self.notes).map(|((optimum, control), note)| {
            let is_short = control.is_refined && !is_confirmed(optimum, accuracy);
            // What the solver found, or what it did not reach, might have been tried again.
            let is_open = optimum.meets_equations() || is_unreached(&optimum.solution);
            if is_open && !optimum.is_solved() {
                optimum.stopped = stopped;
            }
            let n = optimum.motion.intervals();
            match note.take() {
                _ if is_short && optimum.meets_equations() => Some(unconfirmed(optimum, accuracy, why)),
                Some(_) if !optimum.is_solved() => Some(format!(
                    "on finer grids of up to {n} intervals no optimum was reproduced by its inputs either"
                )),
                note => note.map(|of_problem| {
                    format!("{of_problem}; solved again on {n} intervals; this optimum is reproduced by its inputs")
                }),
            }
        });
        ended.collect()
    }
}

/// The solves so far.
pub(super) struct Solves<'a> {
    motions: &'a Motions,
    allowed: SolveLimits,
    observer: &'a mut dyn FnMut(usize, &Iterate<'_>) -> ControlFlow<()>,
    began: Instant,
    iterations: usize,
}

impl<'a> Solves<'a> {
    pub(super) fn new(
        motions: &'a Motions,
        allowed: SolveLimits,
        observer: &'a mut dyn FnMut(usize, &Iterate<'_>) -> ControlFlow<()>,
    ) -> Result<Self, WorkflowError> {
        if let (Some(other), [_, ..]) = (motions.other_grid(), &motions.shared_inputs[..]) {
            return Err(WorkflowError::Problem {
                place: "control.shared_inputs".to_owned(),
                reason: format!(
                    "the instants of the motion \"{}\" are other ones",
                    other.name
                ),
            });
        }
        Ok(Self {
            motions,
            allowed,
            observer,
            began: Instant::now(),
            iterations: 0,
        })
    }

    pub(super) fn left(&self) -> Option<f64> {
        seconds_left(self.allowed.seconds, self.began)
    }

    /// Returns the reason why nothing more may be begun, if there is one.
    pub(super) fn stopped(&self) -> Option<Status> {
        stopped(self.left())
    }

    /// Solves these problems of the motions, from earlier solutions or from their guesses.
    pub(super) fn solve(
        &mut self,
        controls: &[Control],
        earlier: Option<&[&Solution]>,
    ) -> Result<FoundTogether, WorkflowError> {
        let limits = SolveLimits {
            seconds: self.left(),
            ..self.allowed
        };
        let each = self.motions.list.iter().zip(controls).enumerate();
        let asked = each.map(|(k, (motion, control))| MotionAsked {
            name: &motion.name,
            system: &motion.system,
            control,
            earlier: earlier.map(|all| all[k]),
        });
        let asked: Vec<MotionAsked<'_>> = asked.collect();
        let intervals = controls.iter().map(|control| control.intervals).sum();
        let observer = &mut self.observer;
        let found = attempt_together(&asked, self.motions.in_common(), limits, &mut |iterate| {
            observer(intervals, iterate)
        })?;
        let solution = &found.optima[0].solution;
        self.iterations += solution.iterations.len().saturating_sub(1);
        Ok(found)
    }

    /// The first solve of these problems, and where it leads nowhere one from displaced guesses.
    pub(super) fn first(&mut self, controls: &[Control]) -> Result<FoundTogether, WorkflowError> {
        let found = self.solve(controls, None)?;
        if !is_unreached(&found.optima[0].solution) || self.stopped().is_some() {
            return Ok(found);
        }
        phase("second, displaced initial guesses");
        let each = controls.iter().zip(&found.optima);
        let displaced: Vec<Control> = each
            .map(|(control, first)| displaced(control, first))
            .collect();
        let second = self.solve(&displaced, None);
        let second = second.ok().filter(FoundTogether::meets_equations);
        Ok(second.unwrap_or(found))
    }

    /// Solves on finer grids, from the motions before, then from the guesses; the reason where that is not done.
    fn refine(&mut self, before: &OnGrids, intervals: &[usize]) -> Result<OnGrids, &'static str> {
        let OnGrids {
            controls,
            found,
            notes,
        } = before;
        let grown = intervals.iter().zip(controls);
        let grown = grown.map(|(n, control)| *n as f64 / control.intervals as f64);
        let variables = found.whole.variables as f64 * grown.fold(1.0, f64::max);
        if self.stopped().is_some() {
            return Err(STOPPED);
        }
        if variables > VARIABLES as f64 {
            return Err("a finer grid is too large");
        }
        let finer = controls
            .iter()
            .zip(intervals)
            .map(|(control, &intervals)| Control {
                intervals,
                ..control.clone()
            });
        let controls: Vec<Control> = finer.collect();
        let earlier: Vec<&Solution> = found.optima.iter().map(|one| &one.motion).collect();
        let is_found = |found: &FoundTogether| found.meets_equations();
        let mut next = self.solve(&controls, Some(&earlier)).ok().filter(is_found);
        if next.is_none() && self.stopped().is_none() {
            next = self.solve(&controls, None).ok().filter(is_found);
        }
        let mut next = next.ok_or_else(|| match self.stopped() {
            Some(_) => STOPPED,
            None => "a finer grid was not solved",
        })?;
        let mut notes = notes.clone();
        let before = found.optima.iter().zip(&before.controls);
        for (k, (old, control)) in before.enumerate() {
            next.optima[k].carried = old.carried;
            let cause = old.cause().filter(|_| !control.is_refined);
            let told = cause
                .map(|cause| format!("on {} intervals: {}", control.intervals, cause.message()));
            notes[k] = notes[k].take().or(told);
        }
        Ok(OnGrids {
            controls,
            found: next,
            notes,
        })
    }

    /// Intervals of the next grids; none where each verification is passed, or no finer grid is tried. Where inputs are shared all grids stay equal.
    fn finer(&self, controls: &[Control], optima: &[Optimum], accuracy: f64) -> Option<Vec<usize>> {
        let each = self.motions.list.iter().zip(controls).zip(optima);
        let next = each.map(|((motion, control), optimum)| {
            let n = control.intervals;
            match control.is_refined {
                true if is_confirmed(optimum, accuracy) => n,
                true => (n as f64 * factor(optimum, accuracy)).ceil() as usize,
                false if optimum.is_solved() => n,
                false => (2 * n).min(MOST_TIMES * motion.control.intervals),
            }
        });
        let mut next: Vec<usize> = next.collect();
        if !self.motions.shared_inputs.is_empty() {
            let most = next.iter().copied().max().unwrap_or(0);
            next.fill(most);
        }
        let is_finer = next
            .iter()
            .zip(controls)
            .any(|(n, control)| *n > control.intervals);
        is_finer.then_some(next)
    }
}
