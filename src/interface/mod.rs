//! The library as a program uses it: systems built part by part, simulated and steered in memory.
//!
//! - `handle`, `parts`: systems and their parts, with defaults; checked when they are used.
//! - `state`, `free_parameters`, `equilibrium`, `simulation`, `control`, `costs`, `identification`: the tasks of a system.
//! - `motion`, `error`: results and errors.

mod control;
mod costs;
mod equilibrium;
mod error;
mod free_parameters;
mod handle;
mod identification;
mod motion;
mod parts;
mod simulation;
mod state;

pub use control::Control;
pub use control::Together;
pub use equilibrium::Equilibrium;
pub use error::{Error, Result};
pub use handle::Input;
pub use handle::{Carrier, GROUND, Handle, Part};
pub use identification::{Identification, Recording, Tension};
pub use motion::Motion;
pub use motion::Optimum;
pub use simulation::Simulation;
pub use state::State;
