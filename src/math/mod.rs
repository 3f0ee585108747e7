//! Numbers that carry their derivatives, numbers drawn at random, numbers as people read them, disjoint sets of them, two
//! computations at once, when to stop them, and the memory that is there for them.

mod compact_index;
mod derivatives;
mod digits;
mod eigenvalue_bound;
mod jet;
mod join;
pub(crate) mod memory;
mod number;
mod pool;
mod random;
mod sets;
mod signal;
mod stopped;

pub(crate) use compact_index::compact_index;
pub use derivatives::{Derivatives, Gradient, Local};
pub use digits::{no_smaller, shortest, significant};
pub use eigenvalue_bound::largest_eigenvalue_bound;
pub use jet::Jet;
pub use join::cores;
pub(crate) use join::join_if;
pub use number::{Dual, HyperDual, Number};
pub(crate) use pool::has_pool;
pub(crate) use pool::join;
pub use random::Random;
pub use sets::DisjointSets;
pub use signal::{Signal, in_order};
pub use stopped::{IsOver, Stopped};

/// A vector of space.
pub type Vector = nalgebra::Vector3<f64>;
/// A linear map of space.
pub type Matrix = nalgebra::Matrix3<f64>;
