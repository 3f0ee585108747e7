//! Loads that grow, and how equilibria are lost under them.

/// What grows along a path.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Load {
    /// The weights, without voltages.
    Weight,
    /// The voltages, under all weights.
    Voltages,
}

/// How an equilibrium under a growing load is lost.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Instability {
    /// The path turns back: beyond this voltage there is no equilibrium nearby (pull-in).
    PullIn,
    /// The path turns back under growing weights: the robot collapses.
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
            Self::Collapse => "collapse under weight",
            Self::Buckling => "buckling",
        }
    }

    /// What a limit point of a load is.
    pub(super) fn of_turn(load: Load) -> Self {
        match load {
            Load::Weight => Self::Collapse,
            Load::Voltages => Self::PullIn,
        }
    }
}
