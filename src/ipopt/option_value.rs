//! Values of Ipopt's options.

use std::fmt;
use thiserror::Error;

/// A value of an Ipopt option.
#[derive(Clone, Debug, PartialEq)]
pub enum OptionValue {
    /// Integer option.
    Integer(i32),
    /// Real option.
    Number(f64),
    /// Text option.
    Text(String),
}

impl fmt::Display for OptionValue {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Integer(value) => write!(f, "{value}"),
            Self::Number(value) => write!(f, "{value:?}"),
            Self::Text(value) => write!(f, "\"{value}\""),
        }
    }
}

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
