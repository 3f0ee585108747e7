//! Feedback along a motion: gains of linear-quadratic regulators, and the controller that reads them.
//!
//! - `riccati`: one step of the Riccati recursion; `held`: its limit, by doubling; `radius`: whether a closed loop is stable.
//! - `law`: a motion with gains, voltages and bounds; `observer`: its state from fewer quantities; `controller`: inputs from measured
//!   states, step by step.

mod controller;
mod held;
mod law;
mod observer;
mod radius;
mod riccati;

pub use controller::Controller;
pub use held::{HeldGain, NotHeld, held_gain};
pub use law::{Integral, Law, LawInput, Measured, Point};
pub use observer::{Filter, Observer, Reading};
pub use radius::spectral_radius;
pub use riccati::{Costs, RiccatiStep, riccati_step};
