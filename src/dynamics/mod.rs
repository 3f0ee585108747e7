//! Motion in time and rest: two readers of the discrete action.

mod equilibrium;
mod error;
mod history;
mod observe;
mod simulate;
mod stepper;
pub mod trajectory;

pub use equilibrium::{Equilibrium, equilibrium};
pub use error::{EquilibriumError, StepError};
pub use history::History;
pub use observe::{Energies, energies, observations};
pub use simulate::{Start, simulate};
pub use stepper::{Stepper, StepperReport};
