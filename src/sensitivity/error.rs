//! Reasons why an optimum has no sensitivities.

/// A reason why derivatives of an optimum do not exist, or are not known to be right.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum NoSensitivity {
    /// The point is none at which the conditions of an optimum hold.
    #[error("the conditions of an optimum hold up to {0:.1e} only: solve with a smaller tolerance")]
    NotOptimal(f64),
    /// A bound that counts as reached pushes the wrong way, or one that counts as free is violated.
    #[error("it is not known whether {0} is reached: solve with a smaller tolerance")]
    Undecided(String),
    /// The matrix is singular.
    #[error(
        "the equations and bounds that are reached depend on each other, or the optimum is not unique to second order"
    )]
    Singular,
    /// There are directions along which the objective falls.
    #[error(
        "it is no strict minimum: along {0} independent directions the Lagrangian falls to second order"
    )]
    NoMinimum(usize),
    /// There are more equations and bounds than unknowns.
    #[error("more equations and bounds are reached ({rows}) than there are unknowns ({columns})")]
    Overdetermined {
        /// Equations and limits.
        rows: usize,
        /// Unknowns that no bound holds.
        columns: usize,
    },
    /// The linear system was not solved to the accuracy of numbers.
    #[error("its linear system is solved up to {0:.1e} only")]
    Inexact(f64),
    /// Two ways to the same derivative differ.
    #[error(
        "the derivative of the objective is {0:.9e} by multipliers and {1:.9e} along the change of the optimum"
    )]
    Contradicts(f64, f64),
    /// Something that the derivatives need is not offered.
    #[error("{0}")]
    Refused(String),
}
