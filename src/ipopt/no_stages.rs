//! Reasons for which an Ipopt does not take the linear solver along the horizon.

use thiserror::Error;

/// Version of the Ipopt that the program was built with.
pub const VERSION: &str = env!("PROBOSCIS_IPOPT");

/// Reason why this Ipopt does not take the linear solver along the horizon.
#[derive(Clone, Copy, Debug, Error, PartialEq, Eq)]
pub enum NoStages {
    /// Nothing can be in the place of MA57.
    #[error("this Ipopt ({VERSION}) was built to load no linear solvers")]
    WithoutMa57,
    /// Nothing takes the functions.
    #[error("this Ipopt ({VERSION}) shows no function that takes a linear solver")]
    WithoutSetter,
}
