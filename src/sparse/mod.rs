//! Direct solution of square systems with a fixed pattern.
//!
//! [`Direct`] lays the pattern, scales, checks and refines; a [`Factorisation`] is what it does so with.

mod backend;
mod direct;
mod dissection;
mod factorisation;
mod faer;
mod fronts;
pub mod multigrid;
pub(crate) mod mumps;
mod pattern;

pub use backend::{Backend, DENSE};
pub use direct::{Direct, MethodState};
pub use dissection::Places;
pub use factorisation::{Factorisation, Precision, Singular};
pub use pattern::Symmetry;
