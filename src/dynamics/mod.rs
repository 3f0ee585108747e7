//! Motion in time and rest: two readers of the discrete action.
//!
//! - `stepper`: Newton on the equations of one step; `midpoint`: those of the midpoint rule; `stages`: those of every other
//!   method.
//! - `simulate`, `history`, `observe`, `kinetic`: step after step, recorded and observed.
//! - `statics`, `equilibrium`, `continuation`: rest, and paths of it.

mod anderson;
mod continuation;
mod equilibrium;
mod error;
mod history;
mod kinetic;
mod midpoint;
mod observe;
mod simulate;
mod solving;
mod spans;
mod stages;
mod statics;
mod stepper;
mod tangent;
pub mod trajectory;

use continuation::{LimitPoint, limit_point};

pub use continuation::{Continuation, Instability, continuation};
pub use equilibrium::{Equilibrium, equilibrium};
pub use error::{EquilibriumError, StepError};
pub use history::{History, Reading};
pub use midpoint::{Midpoint, Stepper};
pub use observe::{Energies, energies, observations};
pub use simulate::{Start, simulate, simulate_by};
pub use solving::{Integrator, Newton, Solving};
pub use spans::{muscle_without_length, reversed_muscle};
pub use stages::Stages;
pub use stepper::{Equations, StepperReport, Steps};
