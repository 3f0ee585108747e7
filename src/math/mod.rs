//! Numbers that carry their derivatives.

mod jet;

pub use jet::Jet;

/// A vector of space.
pub type Vector = nalgebra::Vector3<f64>;
/// A linear map of space.
pub type Matrix = nalgebra::Matrix3<f64>;
