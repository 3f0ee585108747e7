//! One function for each task: it computes, verifies, and returns numbers, verdict and remarks; a simulation is assessed in a step of its own.
//!
//! - `solve`, `simulate`, `equilibrium`: the three tasks. The commands, Python and the interface for Rust call them; nothing here knows files.
//! - `vibrations`: small motions about an equilibrium.
//! - `check`: the derivatives of a task against differences.
//! - `solve_messages`: texts of the verdict on an optimum.

pub mod check;
pub mod equilibrium;
pub mod simulate;
pub mod solve;
pub(crate) mod solve_messages;
pub mod vibrations;

pub use check::{CheckResult, check};
pub use equilibrium::{EquilibriumResult, EquilibriumTaskError, equilibrium};
pub use simulate::{
    Assessment, DisturbedLoops, SimulationRequest, SimulationResult, disturbed, simulate,
};
pub use solve::{MotionsResult, SolveResult, solve, solve_motions};
pub use solve_messages::Verdict;
pub use vibrations::{FrequencyResponse, Vibrating};

pub use crate::workflow::SolveRequest;
