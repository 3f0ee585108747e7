//! Values of Ipopt's options.

use std::fmt;

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
