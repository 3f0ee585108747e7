//! The problem file: its types as written and their conversion to a [`Task`](crate::control::problem::Task).
//!
//! - `variants`: problems within a problem: motions of a list, scenes of some recordings, parts of a disturbance, what a controller plans anew.
//! - `build`: the problem; `control` with its `objective`, `simulation`, `identify`: its longer tasks.
//! - `feedback`: gains along an optimum, and a controller that reads them.
//! - `at`: places with their system; `state`, `quantities`, `numbers`, `inputs`: their parts; `output`: what is written of a motion.

pub mod at;
pub mod build;
pub mod control;
pub mod feedback;
pub mod identify;
pub mod inputs;
pub mod numbers;
pub mod objective;
pub mod output;
pub mod quantities;
pub mod simulation;
pub mod state;
pub(crate) mod variants;
