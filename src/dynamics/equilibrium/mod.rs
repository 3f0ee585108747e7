//! Static equilibria: under growing loads, along paths, and their stability.
//!
//! - `statics`: Newton on the rows of rest; `static_matrix`, `static_solution`: their matrix and its solvers; `rest_state`: their unknowns, modes and instabilities; `relaxation`: states that Newton's method does not reach.
//! - `ramp`, `growth`: loads that grow; `arc_length`: the path of equilibria by arc length; `load_path`: its points.
//! - `result`, `softest_mode`, `stability`: a state of rest, its softest mode and slowest vibration; `growing_motions`: its stability under loads that follow what they act on; `stable`: the
//!   stable one.

mod arc_length;
mod growing_motions;
mod growth;
mod load_path;
mod ramp;
mod relaxation;
mod rest_state;
mod result;
mod softest_mode;
mod stability;
mod stable;
mod static_matrix;
mod static_solution;
mod statics;

pub use growth::equilibrium;
pub use load_path::{Continuation, continuation};
pub use rest_state::{Instability, Load, LowestMode, Mode, Softening};
pub use result::{Equilibrium, Route, StabilityLoss, UNSTABLE};
pub use softest_mode::lowest_mode;
pub use stable::{stable_equilibrium, stable_equilibrium_by};
