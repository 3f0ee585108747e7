//! Numbers that carry their derivatives, and numbers drawn at random; numbers as people read them.

mod digits;
mod jet;
pub mod random;

pub use digits::significant;
pub use jet::Jet;

/// A vector of space.
pub type Vector = nalgebra::Vector3<f64>;
/// A linear map of space.
pub type Matrix = nalgebra::Matrix3<f64>;
