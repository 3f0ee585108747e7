//! Times of a run in `summary.json`.

use std::time::Instant;

use serde::Serialize;

/// Wall time in s.
#[derive(Clone, Copy, Debug, Default, Serialize)]
pub(super) struct Seconds {
    /// Seconds from reading to the last file but the summary.
    pub(super) total: f64,
    /// Seconds of these for output: tables, figures, page.
    pub(super) writing: f64,
    /// Before the solver or the first step.
    pub(super) setup: f64,
    /// In Ipopt without the callbacks, or in the steps of a simulation.
    pub(super) solver: f64,
    pub(super) objective: f64,
    pub(super) gradient: f64,
    pub(super) constraints: f64,
    pub(super) jacobian: f64,
    pub(super) hessian: f64,
}

impl Seconds {
    /// The files are written, since `writing`; the run began at `began`.
    pub(super) fn wrote(&mut self, began: Instant, writing: Instant) {
        self.total = began.elapsed().as_secs_f64();
        self.writing = writing.elapsed().as_secs_f64();
    }
}
