//! Results of several solves of one problem, combined.

use crate::ipopt::SolverResult;

/// The better of two solves, with the iterations, evaluations and seconds of both.
pub(crate) fn one_of_both(mut first: SolverResult, mut second: SolverResult) -> SolverResult {
    if second.status.is_solved() {
        put_before(&mut second, &first);
        return second;
    }
    put_after(&mut first, &second);
    first
}

/// Adds iterations, evaluations and seconds of an earlier solve.
pub(crate) fn put_before(kept: &mut SolverResult, earlier: &SolverResult) {
    kept.iterations.splice(0..0, earlier.iterations.clone());
    add_calls(kept, earlier);
}

/// Adds iterations, evaluations and seconds of a later solve.
pub(crate) fn put_after(kept: &mut SolverResult, later: &SolverResult) {
    kept.iterations.extend_from_slice(&later.iterations);
    add_calls(kept, later);
}

fn add_calls(kept: &mut SolverResult, other: &SolverResult) {
    kept.seconds += other.seconds;
    kept.evaluations += other.evaluations;
    kept.failed_evaluations += other.failed_evaluations;
}
