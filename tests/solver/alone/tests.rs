//! Those tests of `tests/solver` that need no robot.
#![allow(
    dead_code,
    unreachable_pub,
    reason = "a part of those files is used here"
)]

#[path = "."]
mod common {
    #[path = "../../common/programs.rs"]
    pub(crate) mod programs;
}

#[path = "../horizon.rs"]
mod horizon;
#[path = "../ipopt.rs"]
mod ipopt;
#[path = "../ipopt_stops.rs"]
mod ipopt_stops;
#[path = "../ma57_adapter.rs"]
mod ma57_adapter;
#[path = "../matrices.rs"]
mod matrices;
#[path = "../mpi.rs"]
mod mpi;
#[path = "../one_mumps.rs"]
mod one_mumps;
#[path = "../sparse.rs"]
mod sparse;
#[path = "../stopped.rs"]
mod stopped;
