//! Direct solution of square systems with a fixed pattern.
//!
//! [`Direct`] lays the pattern, scales, checks and refines; a [`Factorisation`] is what it does so with.

mod dense;
mod direct;
mod factorisation;
mod faer;
pub(crate) mod mumps;
mod pattern;
mod symmetry;

pub use direct::{Backend, DENSE, Direct};
pub use factorisation::{Factorisation, Singular};
pub use symmetry::Symmetry;
