//! The final time of a control problem.

/// Final time of a control problem in ms.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Duration {
    /// Given.
    Given(f64),
    /// Free between bounds.
    Free {
        /// Lower bound.
        min: f64,
        /// Upper bound.
        max: f64,
        /// Value at which the solver starts.
        guess: f64,
    },
}

impl Duration {
    /// Returns the value at which the solver starts.
    pub fn first(self) -> f64 {
        match self {
            Self::Given(duration) => duration,
            Self::Free { guess, .. } => guess,
        }
    }

    /// The duration allowed that is nearest to `other`.
    pub fn nearest(self, other: f64) -> f64 {
        match self {
            Self::Given(duration) => duration,
            Self::Free { min, max, .. } => other.clamp(min, max),
        }
    }
}
