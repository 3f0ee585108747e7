//! Direct solution of square systems with a fixed pattern.

mod direct;

pub use direct::{Direct, Singular};
