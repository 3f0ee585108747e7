//! The verdict on an optimum: by verification, by the end where it has to be held, and by the solver.

use crate::control::problem::{Control, Hold};
use crate::ipopt::Status;
use crate::tasks::solve_messages::{meaning, redundancy, stopped_after, unresolved};
use crate::workflow::cause::Cause;
use crate::workflow::optimum::Optimum;

/// The verdict on a motion.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Verdict {
    /// Its status: `solved`, `not_reproduced`, `not_held`, `infeasible`, ….
    pub word: &'static str,
    /// True if the motion is what was asked for.
    pub is_solved: bool,
    /// Reason why it is not, in words.
    pub message: Option<String>,
}

impl Verdict {
    /// The verdict on an optimum whose end is not kept for a reason, if any.
    pub(super) fn from_optimum(
        control: &Control,
        optimum: &Optimum,
        not_kept: Option<&str>,
    ) -> Self {
        let Optimum {
            model, boundary, ..
        } = optimum;
        let refuted = optimum.reversed.map(|(k, m)| unresolved(model, k, m));
        let refuted = refuted.or_else(|| optimum.cause().map(Cause::message));
        let is_interrupted = optimum.stopped == Some(Status::Interrupted);
        let mut is_solved = optimum.is_solved() && !is_interrupted;
        let mut word = optimum.word();
        let has_to_hold = is_solved && control.hold == Hold::Required;
        let not_held = not_kept.filter(|_| has_to_hold).map(str::to_owned);
        if not_held.is_some() {
            (is_solved, word) = (false, "not_held");
        }
        let mut message = refuted.or(not_held);
        if message.is_none() && !is_solved {
            let status = optimum.solution.status;
            message = Some(match optimum.stopped {
                Some(stopped) => stopped_after(status, stopped),
                None => meaning(status).to_owned(),
            });
        }
        if let (Some(message), false) = (&mut message, optimum.meets_equations()) {
            message.push_str(&redundancy(&model.redundant_constraints(&boundary.start.z)));
        }
        Self {
            word,
            is_solved,
            message,
        }
    }
}
