//! Motion in time and rest: two readers of the discrete action.

mod anderson;
mod continuation;
mod equilibrium;
mod error;
mod history;
mod observe;
mod simulate;
mod spans;
mod statics;
mod stepper;
mod tangent;
pub mod trajectory;

use continuation::{LimitPoint, limit_point};

pub use continuation::{Continuation, Instability, continuation};
pub use equilibrium::{Equilibrium, equilibrium};
pub use error::{EquilibriumError, StepError};
pub use history::History;
pub use observe::{Energies, energies, observations};
pub use simulate::{Start, simulate, simulate_by};
pub use spans::{muscle_without_length, reversed_muscle};
pub use stepper::{Newton, Solving, Stepper, StepperReport};
