//! Optimal control: direct transcription of the discrete action (DMOCC).

mod boundary;
mod calls;
mod conditions;
mod ends;
mod error;
mod evened;
mod guess;
mod limits;
mod objective;
pub mod problem;
mod resample;
mod solution;
mod transcription;
mod unknowns;

pub use boundary::resolve_start;
pub use conditions::{Boundary, Goal};
pub use error::BoundaryError;
pub use guess::{Initial, guess};
pub use limits::{Bounded, Limits, Place};
pub use objective::Cost;
pub use solution::{Costates, Solved};
pub use transcription::Transcription;
pub use unknowns::{Row, Unknowns, Variable};
