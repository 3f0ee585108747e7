//! Words for a solve that found no solution.

use crate::ipopt::Status;

/// A further reason why a solve failed, where there is one.
pub(super) fn redundancy(redundant: &[String]) -> String {
    match redundant {
        [] => String::new(),
        names => format!(
            "; constraints are redundant at the start: {} more than is needed, such as {}",
            names.len(),
            names.join(", ")
        ),
    }
}

/// What a status means for the problem.
pub(super) fn meaning(status: Status) -> &'static str {
    match status {
        Status::Infeasible | Status::RestorationFailed => {
            "no motion that satisfies the goal and the limits was found from this guess; the files hold the iterate that violates them least"
        }
        Status::IterationLimit => {
            "the iterations allowed were used up; the files hold the last iterate"
        }
        Status::TimeLimit => "the time allowed was used up; the files hold the last iterate",
        Status::Interrupted => "interrupted; the files hold the last iterate",
        Status::InvalidNumber => {
            "an equation or a derivative has no value at an iterate: the ends of a muscle meet there, or an element is inverted; the files hold the last iterate; take another guess or more intervals"
        }
        Status::TooFewDegreesOfFreedom => "there are more equations than unknowns",
        _ => "the solver stopped early; the files hold the last iterate",
    }
}
