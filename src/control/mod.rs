//! Optimal control.
pub mod problem;
