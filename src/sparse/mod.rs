//! Direct solution of square systems with a fixed pattern.
//!
//! [`Direct`] lays the pattern, scales, checks and refines; a [`Factorisation`] is what it does so with.

mod backend;
mod direct;
mod dissection;
mod factorisation;
mod faer;
mod fronts;
mod method_state;
pub mod multigrid;
pub(crate) mod mumps;
mod pattern;
mod precision;
mod scaling;

pub use backend::{Backend, DENSE};
pub use direct::Direct;
pub use dissection::Places;
pub use factorisation::{Factorisation, Singular};
pub use method_state::MethodState;
pub use pattern::Symmetry;
pub use precision::Precision;
