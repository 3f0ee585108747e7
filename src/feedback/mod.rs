//! Feedback along a motion: gains of linear-quadratic regulators, and the controller that reads them.
//!
//! - `held`: gains that hold a state, the limit of the Riccati recursion; `law`: a motion with gains, voltages and bounds.
//! - `observer`: the state of a motion from fewer quantities; `controller`: inputs from measured states, step by step.

mod controller;
mod held;
mod law;
mod observer;

pub use controller::{Controller, DelayLine, Estimate};
pub use held::spectral_radius;
pub(crate) use held::symmetric;
pub use held::{Costs, RiccatiStep, riccati_step};
pub use held::{HeldGain, NotHeld, held_gain};
pub use law::{Integral, Law, LawInput, Measured, Memory, Point};
pub use observer::{Filter, Observer, Reading};
pub use observer::{Forced, Lasting};
