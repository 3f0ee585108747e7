//! Several motions: solved together, each verified by a simulation and held after its end.

use std::ops::ControlFlow;

use crate::control::{Motion, Motions};
use crate::tasks::solve::{SolveResult, Solved, solve_task};
use crate::tasks::solve_messages;
use crate::tasks::solve_messages::Verdict;
use crate::workflow::accuracy::Accuracy;
use crate::workflow::remark::STOPPED_EARLY;
use crate::workflow::{Iterate, Remarks, SolveRequest, WholeProgram, WorkflowError};

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
    let Solved {
        list,
        whole,
        iterations,
        accuracy,
    } = solve_task(&motions.task(), request, observer)?;
    let mut remarks = Remarks::default();
    remarks.warn("optimality_gap", whole.wide.clone());
    let mut each = list.iter();
    let cut_short = each.find_map(|one| one.optimum.cut_short);
    remarks.warn(STOPPED_EARLY, cut_short.map(solve_messages::cut_short));
    remarks.warn("shared_inputs", held_apart(motions, &list));
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
