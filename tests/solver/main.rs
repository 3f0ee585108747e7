//! Ipopt, MUMPS and faer behind their interfaces, and callbacks that fail.

#[path = "../common/mod.rs"]
mod common;

mod again;
mod checker;
mod condensed;
mod constrained;
mod faults;
mod horizon;
mod ipopt;
mod ipopt_stops;
mod kkt;
mod linear_solver;
mod lowest_modes;
mod ma57_adapter;
mod matrices;
mod mpi;
mod multigrid;
mod one_mumps;
mod precision;
mod random_systems;
mod recorded;
mod recorder;
mod sparse;
mod stopped;
