//! Motion in time and rest: two readers of the discrete action.
//!
//! - `stepper`: Newton on the equations of one step; `midpoint`: those of the midpoint rule; `galerkin`: those of every other
//!   method.
//! - `newton_matrix`, `tangent`: the matrix of Newton's method, by factors or by multigrid.
//! - `updates`, `contraction`: updates of an iteration, with kept factors, and how they shrink; `solving`: settings of method and solution.
//! - `simulate`, `trajectory`, `observe`, `part_columns`, `momenta`, `energies`: step after step, recorded and observed, and resumed.
//! - `resolution`: steps that are refused, and the error of those that are not; `singular_configurations`: places where laws end, and the end of
//!   the first-order dielectric.
//! - `wrinkles`: membranes that are compressed.
//! - `exchange`: electrical energy from the sources and mechanical work of their muscles.
//! - `state_space`: steps linearised by state and inputs; `independent`: coordinates of closed loops that determine the others; `loop_rates`: rates
//!   of their joints, completed from those that are named, and changes of coordinates that constraints leave free.
//! - `equilibrium`: states of rest.

mod contraction;
mod energies;
mod equilibrium;
mod error;
mod exchange;
mod galerkin;
mod independent;
mod loop_rates;
mod midpoint;
mod momenta;
mod newton_matrix;
mod observe;
mod part_columns;
mod resolution;
mod simulate;
mod singular_configurations;
mod solving;
mod state_space;
mod stepper;
mod tangent;
pub mod trajectory;
mod updates;
mod wrinkles;

pub use energies::{Energies, Work, energies};
pub use equilibrium::{
    Equilibrium, Instability, Load, LowestMode, Mode, Modes, PathStop, Route, Softening,
    StabilityLoss, UNSTABLE, Vibration, Vibrations, continuation, equilibrium, lowest_mode,
    stable_equilibrium, stable_equilibrium_by,
};
pub use error::{EquilibriumError, StepError};
pub use exchange::{EnergyExchange, SourceEnergies};
pub use galerkin::GalerkinEquations;
pub use independent::{Closing, Independent, NoState, Slopes};
pub use loop_rates::{IndependentChanges, rates_in_loops};
pub use midpoint::{Midpoint, Stepper};
pub use momenta::{Start, last_momentum, rates_of_momentum};
pub use observe::{observations, observed};
pub use resolution::{
    Balance, LocalError, STEPS_OF_TOUCH, ShortTouch, distance_between, least_gaps, local_error,
    short_touches,
};
pub use simulate::{Lengths, StepControl, go_on, simulate, simulate_by};
pub use singular_configurations::{
    OutOfDomain, OutOfRange, largest_stretch, muscle_beyond_law, out_of_domain, out_of_range,
    part_without_energy, reversed_muscle,
};
pub use solving::{Drive, Inputs, Integrator, MultigridUse, Newton, Solving};
pub use state_space::{LinearStep, Linearisation, StepInput, momentum_derivatives, step_inputs};
pub use stepper::{Equations, Steps};
pub use trajectory::{DiscreteTrajectory, Reading, StepState, StepperReport, TangentState};
pub use wrinkles::{Wrinkle, wrinkles};
