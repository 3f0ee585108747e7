//! Messages about iterations with multigrid.

use crate::ipopt::Status;

/// The warning where a direct solver took over from an iteration.
pub(crate) fn warning(fallbacks: usize) -> Option<String> {
    (fallbacks > 0).then(|| {
        "the iteration with multigrid did not converge, and a direct solver took over: \"linear_solver\": \"faer\" takes it from the start"
            .to_owned()
    })
}

/// The warning where an equilibrium was found without factors, whose inertia would prove its stability, and the lowest mode does not; as it was
/// `stopped` perhaps.
pub(crate) fn undecided(stopped: Option<Status>) -> String {
    match stopped {
        Some(status) => format!(
            "stability is not known: the search for the lowest mode was stopped ({})",
            status.word().replace('_', " ")
        ),
        None => "stability is not known: the matrix is too large to be factorised, and the lowest mode was not found within a bound that decides"
            .to_owned(),
    }
}
