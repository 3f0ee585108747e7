//! Optimal control: direct transcription of the discrete action (DMOCC).

mod at_rest;
mod boundary;
mod boundary_conditions;
mod boundary_state;
mod costs;
mod endpoint_checks;
mod error;
mod free_parameters;
mod goal;
mod guess;
mod identification;
mod implicit;
mod inputs;
mod limits;
mod numbering;
mod objective;
mod passed_limits;
mod phases;
mod prescribed;
pub mod problem;
mod regulator;
mod required_analysis;
mod resample;
mod rest_program;
mod transcription;

pub(crate) use boundary::obstacle as hold_obstacle;
pub use boundary_conditions::{
    BoundaryConditions, MomentumSlopes, Rests, TerminalState, momentum_slopes, resolve_start,
    rest_at,
};
pub use boundary_state::EndState;
pub use error::BoundaryError;
pub(crate) use free_parameters::ends_that_read;
pub use goal::{Orientation, Place};
pub use guess::{Carried, InitialGuess, guess};
pub use identification::{Costates, Earlier, EarlierSolution, Solution};
pub use implicit::{MotionDerivatives, StartDerivatives};
pub use limits::{BoundedQuantity, Limits, When};
pub use numbering::{Column, Numbering, Row, Span};
pub use objective::Cost;
pub use passed_limits::{LimitsAlong, PassedLimit, limits_along, measured_value};
pub use problem::{Motion, Motions};
pub use rest_program::{PEAK_VOLTAGE, RestProgram, rest_programs};
pub use transcription::{Outline, Transcription};
