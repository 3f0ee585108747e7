//! One function for each task: it computes, verifies, and returns numbers, verdict and remarks; a simulation is assessed in a step of its own.
//!
//! - `solve`, `simulate`, `equilibrium`: the three tasks. The commands, Python and the interface for Rust call them; nothing here knows files.
//! - `held_goal`: the solves of control problems whose goals are kept.
//! - `disturbed`: a closed loop with parts of its disturbance.
//! - `motions`: several control problems solved together.
//! - `check`: the derivatives of a task against differences.
//! - `solve_messages`: texts of the verdict on an optimum.

pub mod check;
mod disturbed;
pub mod equilibrium;
mod held_goal;
pub mod motions;
pub mod simulate;
pub mod solve;
pub(crate) mod solve_messages;

pub use check::{CheckResult, GreatestErrors, WrongDerivative, check};
pub use disturbed::{DisturbedLoops, disturbed};
pub use equilibrium::{EquilibriumResult, EquilibriumTaskError, equilibrium};
pub use motions::{MotionsResult, solve_motions};
pub use simulate::{Assessment, SimulationRequest, SimulationResult, simulate};
pub use solve::{SolveResult, solve};
pub use solve_messages::Verdict;

pub use crate::workflow::SolveRequest;
