//! The origin of the inputs of a controller that plans anew.

/// Origin of the inputs of a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Source {
    /// The plan, with what was measured.
    Plan,
    /// The plan as it was: nothing was measured in time.
    Late,
    /// The plan as it was: what was measured is no state of the system.
    Unusable,
    /// The plan as it was: its iteration failed.
    Kept,
    /// The law of the regulator: the plan has failed, and begins anew.
    Regulator,
}

impl Source {
    /// All of them.
    pub const ALL: [Self; 5] = [
        Self::Plan,
        Self::Late,
        Self::Unusable,
        Self::Kept,
        Self::Regulator,
    ];

    /// Its name in a word.
    pub fn word(self) -> &'static str {
        match self {
            Self::Plan => "plan",
            Self::Late => "late",
            Self::Unusable => "unusable",
            Self::Kept => "kept",
            Self::Regulator => "regulator",
        }
    }
}
