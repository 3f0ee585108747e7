//! Lobatto points, and the contraction of a Newton iteration.

#[path = "../../src/dynamics/contraction.rs"]
mod contraction;
#[path = "../../src/dynamics/galerkin/lobatto.rs"]
pub(crate) mod lobatto;

pub(crate) mod galerkin {
    pub(crate) use super::lobatto;
}

pub(crate) mod solving {
    pub(crate) use proboscis::dynamics::Newton;
}
