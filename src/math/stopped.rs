//! Error of long work that was stopped before its end, and the callback that requests the stop.

/// The work has no result, because it was time to stop.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("stopped before the end")]
pub struct Stopped;

/// Callback that returns true when work is to stop; called on any thread.
pub type IsOver<'a> = &'a (dyn Fn() -> bool + Sync);
