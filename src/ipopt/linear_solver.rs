//! Who solves the linear systems of Ipopt.

use crate::ipopt::hook;

/// Who solves the linear systems of Ipopt.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum LinearSolver {
    /// [`LinearSolver::Stages`] where Ipopt takes it, else [`LinearSolver::Mumps`].
    #[default]
    Auto,
    /// [`kkt`](crate::kkt), in the order of the horizon.
    Stages,
    /// MUMPS, one solve at a time in a process.
    Mumps,
}

impl LinearSolver {
    /// What is taken: never [`LinearSolver::Auto`]. `None` if this Ipopt does not take it.
    pub(super) fn resolve(self) -> Option<Self> {
        match self {
            Self::Auto if hook::install() => Some(Self::Stages),
            Self::Auto => Some(Self::Mumps),
            Self::Stages => hook::install().then_some(self),
            Self::Mumps => Some(self),
        }
    }

    /// How Ipopt calls it.
    pub(super) const fn name(self) -> &'static str {
        match self {
            Self::Auto | Self::Stages => "ma57",
            Self::Mumps => "mumps",
        }
    }

    /// Whether this Ipopt takes [`LinearSolver::Stages`].
    #[must_use]
    pub fn has_stages() -> bool {
        hook::install()
    }
}
