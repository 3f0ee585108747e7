//! Static equilibria: under growing loads, along paths, and their stability.
//!
//! - `statics`: Newton on the rows of rest, by factors or by an iteration; `static_matrix`: their matrix; `relaxation`: states that Newton's method does
//!   not reach.
//! - `growth`: loads that grow; `arc_length`: the path of equilibria by arc length.
//! - `rest_state`: a state of rest; `softest_mode`: its softest mode and slowest vibration; `growing_motions`: its stability; `stable`: the stable
//!   one, and the points of a path.
//! - `vibrations`: natural frequencies, damping ratios and shapes, by `krylov`; `frequency_response`: the response to inputs that oscillate.

mod arc_length;
mod frequency_response;
mod growing_motions;
mod growth;
mod krylov;
mod relaxation;
mod rest_state;
mod softest_mode;
mod stable;
mod static_matrix;
mod statics;
mod vibrations;

pub use growth::equilibrium;
pub use rest_state::{
    Equilibrium, Instability, Load, LowestMode, Mode, Route, Softening, StabilityLoss, UNSTABLE,
};
pub use softest_mode::lowest_mode;
pub use stable::{PathStop, continuation, stable_equilibrium, stable_equilibrium_by};
pub use vibrations::{Modes, Vibration, Vibrations};
