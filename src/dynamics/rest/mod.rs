//! Static equilibria: under growing loads, along paths, and their stability.
//!
//! - `statics`: Newton on the rows of rest; `settle`, `minimum`: states that Newton's method does not reach.
//! - `instability`, `ramp`, `growth`: loads that grow; `arc`: the path of equilibria by arc length; `continuation`: its points.
//! - `in_joints`: equilibria in redundant coordinates by way of joint coordinates.
//! - `equilibrium`, `mode`, `softest`, `stability`: a state of rest and its softest mode; `stable`: the stable one.

mod arc;
mod continuation;
mod equilibrium;
mod growth;
mod in_joints;
mod instability;
mod minimum;
mod mode;
mod ramp;
mod settle;
mod softest;
mod stability;
mod stable;
mod statics;

pub use continuation::{Continuation, continuation};
pub use equilibrium::{Equilibrium, Route, StabilityLoss};
pub use growth::equilibrium;
pub use instability::{Instability, Load};
pub use mode::{Mode, Softening};
pub use stable::stable_equilibrium;
