//! Static equilibria: under growing loads, along paths, and their stability.
//!
//! - `statics`: Newton on the rows of rest; `static_matrix`, `static_solution`: their matrix and its solvers; `rest_state`, `states`: their unknowns; `settle`, `relaxation`: states that Newton's method does not reach.
//! - `instability`, `ramp`, `growth`: loads that grow; `arc_length`: the path of equilibria by arc length; `load_path`: its points.
//! - `in_joints`: equilibria in redundant coordinates by way of joint coordinates.
//! - `result`, `mode`, `softest_mode`, `stability`: a state of rest and its softest mode; `growing_motions`: its stability under loads that follow what they act on; `examined`, `lowest_mode`: its lowest mode without factors; `slowest_mode`: its slowest vibration; `stable`: the
//!   stable one.

mod arc_length;
mod examined;
mod growing_motions;
mod growth;
mod instability;
mod load_path;
mod mode;
mod ramp;
mod relaxation;
mod rest_state;
mod result;
mod slowest_mode;
mod softest_mode;
mod stability;
mod stable;
mod states;
mod static_matrix;
mod static_solution;
mod statics;

pub use examined::LowestMode;
pub use growth::equilibrium;
pub use instability::{Instability, Load};
pub use load_path::{Continuation, continuation};
pub use mode::{Mode, Softening};
pub use result::{Equilibrium, Route, StabilityLoss, UNSTABLE};
pub use softest_mode::lowest_mode;
pub use stable::{stable_equilibrium, stable_equilibrium_by};
