//! Numbers that carry their derivatives, and numbers drawn at random.

mod jet;
pub mod random;

pub use jet::Jet;

/// A vector of space.
pub type Vector = nalgebra::Vector3<f64>;
/// A linear map of space.
pub type Matrix = nalgebra::Matrix3<f64>;
