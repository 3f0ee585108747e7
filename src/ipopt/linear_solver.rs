//! Choice of the solver of the linear systems of Ipopt.

use crate::ipopt::ma57_adapter;
use crate::ipopt::no_stages::NoStages;

/// Name of MUMPS in Ipopt.
pub(super) const MUMPS: &str = "mumps";

/// Solver of the linear systems of Ipopt.
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

/// The linear solver that a solve takes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Taken<'o> {
    /// Name of the solver in Ipopt.
    pub(super) name: &'o str,
    /// True if it is the one along the horizon.
    pub(super) is_along: bool,
    /// Reason why it is another one, where nothing else was asked for.
    pub(super) why_not: Option<NoStages>,
}

impl LinearSolver {
    /// Returns the solver that is taken: an error if this Ipopt does not take it.
    pub(super) fn taken(self) -> Result<Taken<'static>, NoStages> {
        let stages = Taken {
            name: "ma57",
            is_along: true,
            why_not: None,
        };
        let mumps = |why_not| Taken {
            name: MUMPS,
            is_along: false,
            why_not,
        };
        match self {
            Self::Auto => {
                Ok(ma57_adapter::install().map_or_else(|why| mumps(Some(why)), |()| stages))
            }
            Self::Stages => ma57_adapter::install().map(|()| stages),
            Self::Mumps => Ok(mumps(None)),
        }
    }

    /// Returns true if this Ipopt takes [`LinearSolver::Stages`].
    #[must_use]
    pub fn has_stages() -> bool {
        ma57_adapter::install().is_ok()
    }
}
