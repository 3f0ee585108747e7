//! Optimal control: direct transcription of the discrete action (DMOCC).

mod boundary;
mod calls;
mod conditions;
mod earlier;
mod ends;
mod energy_cost;
mod error;
mod evened;
mod goal;
mod goal_rows;
mod guess;
mod limits;
mod numbering;
mod objective;
pub mod problem;
mod quantity_cost;
mod resample;
mod rest;
mod signal;
mod solution;
mod sought;
mod transcription;

pub use boundary::resolve_start;
pub use conditions::{BoundaryConditions, Rests, TerminalState};
pub use earlier::{Earlier, EarlierSolution};
pub use error::BoundaryError;
pub use goal::{Orientation, Place};
pub use guess::{Carried, InitialGuess, guess};
pub use limits::{BoundedQuantity, Limits, When};
pub use numbering::{Column, Numbering, Row};
pub use objective::Cost;
pub use signal::Signal;
pub use solution::{Costates, Solution};
pub use transcription::Transcription;
