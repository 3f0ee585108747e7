//! Feedback along a motion: gains of linear-quadratic regulators, and the controller that reads them.
//!
//! - `held`: gains that hold a state, the limit of the Riccati recursion; `law`: a motion with gains, voltages and bounds, and its observer.
//! - `controller`: inputs from measured states, step by step.

mod controller;
mod held;
mod law;

pub use controller::{Controller, DelayLine, Estimate};
pub use held::{Costs, HeldGain, NotHeld, RiccatiStep, held_gain, riccati_step, spectral_radius};
pub(crate) use held::{product, symmetric};
pub use law::{
    Filter, Forced, Integral, Lasting, Law, LawInput, Measured, Memory, Observer, Point, Reading,
};
