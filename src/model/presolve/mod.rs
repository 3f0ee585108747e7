//! The rest of a system after presolve, with the graph of its joints, the loops that they close, and prescribed coordinates.

pub(super) mod graph;
pub(super) mod immobile;
pub(super) mod linkage;
pub(super) mod loops;
pub(super) mod prescribed;
pub(super) mod presolved;
pub(super) mod redundancy;
pub(super) mod tree_drifts;
