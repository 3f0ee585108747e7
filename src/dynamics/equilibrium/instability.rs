//! Growing loads, and the instabilities by which equilibria are lost under them.

/// Load that grows along a path.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Load {
    /// The weights and the loads, without voltages.
    Forces,
    /// The voltages, under all weights and loads.
    Voltages,
}

/// Instability by which an equilibrium under a growing load is lost.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Instability {
    /// The path turns back: beyond this voltage there is no equilibrium nearby (pull-in).
    PullIn,
    /// The path turns back under growing weights or loads: the robot collapses.
    Collapse,
    /// The path goes on, but another one branches off and is preferred (buckling).
    Buckling,
}

impl Instability {
    /// The word in files.
    pub fn key(self) -> &'static str {
        match self {
            Self::PullIn => "pull_in",
            Self::Collapse => "collapse",
            Self::Buckling => "buckling",
        }
    }

    /// The word in sentences.
    pub fn words(self) -> &'static str {
        match self {
            Self::PullIn => "pull-in",
            Self::Collapse => "collapse under load",
            Self::Buckling => "buckling",
        }
    }

    /// Returns the instability at a limit point of a load.
    pub(super) fn of_turn(load: Load) -> Self {
        match load {
            Load::Forces => Self::Collapse,
            Load::Voltages => Self::PullIn,
        }
    }
}
