//! Several motions: solved together, each verified by a simulation and held after its end.

use std::borrow::Cow;
use std::ops::ControlFlow;
use std::time::Instant;

use crate::control::{Motion, Motions};
use crate::tasks::grid::{Found, SolveRequest};
use crate::tasks::held_goal::{NOT_FOUND, UNFINISHED, held, is_kept, is_left};
use crate::tasks::solve::{SolveResult, assessed};
use crate::tasks::solve_messages;
use crate::tasks::solve_messages::Verdict;
use crate::workflow::accuracy::{Accuracy, AccuracyTarget};
use crate::workflow::memory::{self, Occasion};
use crate::workflow::optimum::{SolveLimits, seconds_left};
use crate::workflow::remark::STOPPED_EARLY;
use crate::workflow::restarts::stopped;
use crate::workflow::{
    ACCURACY, Iterate, Remarks, Together, WholeProgram, WorkflowError, optimise_together,
    optimise_together_to,
};

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

/// Solves for several motions as one program; each is verified, refined and held as one by itself. `observer` sees the number of all intervals
/// and every iterate.
///
/// # Errors
/// As of `solve` of one motion.
pub fn solve_motions(
    motions: &Motions,
    request: SolveRequest,
    observer: &mut dyn FnMut(usize, &Iterate<'_>) -> ControlFlow<()>,
) -> Result<MotionsResult, WorkflowError> {
    for motion in &motions.list {
        memory::of_elements(&motion.system, Occasion::Factors)?;
    }
    let ((found, accuracy), motions, notes) = solve_and_hold(motions, request, observer)?;
    let Together {
        optima,
        whole,
        iterations,
        notes: of_grids,
    } = found;
    let each = motions.list.iter().zip(optima).zip(of_grids).zip(notes);
    let list = each.map(|(((motion, optimum), note), not_found)| {
        let found = Found {
            optimum,
            iterations,
            accuracy: None,
            note,
        };
        assessed(&motion.system, &motion.control, found, not_found)
    });
    let list: Vec<SolveResult> = list.collect();
    let mut remarks = Remarks::default();
    remarks.warn("optimality_gap", whole.wide.clone());
    let mut each = list.iter();
    let cut_short = each.find_map(|one| one.optimum.cut_short);
    remarks.warn(STOPPED_EARLY, cut_short.map(solve_messages::cut_short));
    remarks.warn("shared_inputs", held_apart(&motions, &list));
    Ok(MotionsResult {
        verdict: verdict(&motions.list, &list),
        list,
        whole,
        iterations,
        accuracy,
        remarks,
    })
}

/// Inputs that differ by less, relative to the largest, are the same.
const SAME: f64 = 1e-6;

/// That inputs which are the same in all motions are different ones after the end, where goals are held.
fn held_apart(motions: &Motions, list: &[SolveResult]) -> Option<String> {
    let apart = motions.shared_inputs.iter().filter(|name| {
        let each = motions.list.iter().zip(list);
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
fn verdict(motions: &[Motion], list: &[SolveResult]) -> Verdict {
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
            let named = motions.iter().zip(verdicts());
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

/// Motions with their estimated errors, where an accuracy is wanted of motions that name their intervals.
type FoundMotions = (Together, Option<Accuracy>);

/// Solves on the grids of the problems, or on finer ones where an accuracy is wanted.
fn find(
    motions: &Motions,
    SolveRequest { wanted, limits }: SolveRequest,
    observer: &mut dyn FnMut(usize, &Iterate<'_>) -> ControlFlow<()>,
) -> Result<FoundMotions, WorkflowError> {
    let are_given = motions.list.iter().all(|one| !one.control.is_refined);
    if let (true, Some(wanted)) = (are_given, wanted) {
        let found = optimise_together_to(motions, wanted, limits, observer);
        return found.map(|(found, accuracy)| (found, Some(accuracy)));
    }
    let accuracy = match wanted {
        Some(AccuracyTarget::Below(part)) => part,
        _ => ACCURACY,
    };
    Ok((
        optimise_together(motions, accuracy, limits, observer)?,
        None,
    ))
}

/// Motions, the problems that they solve, and for each a note where no inputs that hold its goal were found.
type HeldGoals<'a> = (FoundMotions, Cow<'a, Motions>, Vec<Option<String>>);

/// Solves, and again with the inputs that hold the goals that are left as unknowns; for each motion a note where none were found.
fn solve_and_hold<'a>(
    motions: &'a Motions,
    request: SolveRequest,
    observer: &mut dyn FnMut(usize, &Iterate<'_>) -> ControlFlow<()>,
) -> Result<HeldGoals<'a>, WorkflowError> {
    let began = Instant::now();
    let (mut found, accuracy) = find(motions, request, observer)?;
    hold(&mut found, motions);
    let each = motions.list.iter().zip(&found.optima);
    let left: Vec<bool> = each
        .map(|(motion, optimum)| is_left(optimum, &motion.control))
        .collect();
    let told = |note: &str| {
        left.iter()
            .map(|is_left| is_left.then(|| note.to_owned()))
            .collect()
    };
    let none = left.iter().map(|_| None).collect();
    if !left.contains(&true) {
        return Ok(((found, accuracy), Cow::Borrowed(motions), none));
    }
    let seconds = seconds_left(request.limits.seconds, began);
    if stopped(seconds).is_some() {
        return Ok(((found, accuracy), Cow::Borrowed(motions), told(UNFINISHED)));
    }
    let each = motions.list.iter().zip(&found.optima).zip(&left);
    let again = each.map(|((motion, optimum), is_left)| Motion {
        control: held(&motion.control, optimum, *is_left),
        ..motion.clone()
    });
    let again = Motions {
        list: again.collect(),
        shared_inputs: motions.shared_inputs.clone(),
        combined: motions.combined,
    };
    let limits = SolveLimits {
        seconds,
        ..request.limits
    };
    match find(&again, SolveRequest { limits, ..request }, observer) {
        Ok((mut second, of_second)) => {
            hold(&mut second, &again);
            second.iterations += found.iterations;
            let mut each = again.list.iter().zip(&second.optima).zip(&left);
            if each.all(|((motion, optimum), is_left)| {
                optimum.is_solved() && (!is_left || is_kept(optimum, &motion.control))
            }) {
                for (new, old) in second.optima.iter_mut().zip(&found.optima) {
                    new.carried = old.carried;
                }
                return Ok(((second, of_second), Cow::Owned(again), none));
            }
            found.iterations = second.iterations;
        }
        Err(error) => tracing::debug!(%error, "the inputs that hold the goals are not sought"),
    }
    Ok(((found, accuracy), Cow::Borrowed(motions), told(NOT_FOUND)))
}

/// Holds the voltages of the goals after the ends.
fn hold(found: &mut Together, motions: &Motions) {
    let each = found.optima.iter_mut().zip(&motions.list);
    each.for_each(|(optimum, motion)| optimum.hold(&motion.control));
}
