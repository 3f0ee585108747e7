//! A controller that plans anew in each interval: nonlinear model predictive control by real-time iterations.
//!
//! - `horizon`: all that controllers share, from an optimal motion and the costs of its regulator.
//! - `program`: the nonlinear program of the next intervals, and the motion that is followed with the costs of deviations.
//! - `iteration`: one iteration of it, in two parts.
//! - `state`: where a plan begins, from what is measured, over a delay and with an observer.
//! - `controller`: inputs from what is measured, step by step, and what stands in where a step fails, by their `source`.

mod controller;
mod horizon;
mod iteration;
mod program;
mod state;

pub use controller::{Answer, RecedingHorizon};
pub use horizon::{Horizon, NoHorizon};
pub use iteration::Residual;
pub use state::Source;
