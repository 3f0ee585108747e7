//! Numbers that carry their derivatives, numbers drawn at random, numbers as people read them, rules that they break, disjoint sets
//! of them, two computations at once, when to stop them, and the memory that is there for them.

mod derivatives;
mod fault;
mod jet;
pub(crate) mod join;
mod number;
mod sets;
mod signal;

pub use derivatives::{Derivatives, Gradient, Local, largest_eigenvalue_bound};
pub(crate) use fault::refuse;
pub use fault::{
    DIRECTION, Fault, Key, WHOLE, no_smaller, not_negative, positive, prefixed, shortest,
    significant, unique,
};
pub use jet::Jet;
pub use join::cores;
pub(crate) use join::{has_pool, join, join_if};
pub use number::{Dual, HyperDual, Number};
pub(crate) use sets::compact_index;
pub use sets::{DisjointSets, IsOver, Stopped};
pub use signal::{Random, Signal, in_order};

/// A vector of space.
pub type Vector = nalgebra::Vector3<f64>;
/// A linear map of space.
pub type Matrix = nalgebra::Matrix3<f64>;
