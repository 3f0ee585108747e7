//! Long work that may be told to stop in its midst.

/// The matrix is not factorised, because it was time to stop.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("stopped within a factorisation")]
pub struct Stopped;

/// Whether it is time to stop; asked on any thread.
pub type IsOver<'a> = &'a (dyn Fn() -> bool + Sync);
