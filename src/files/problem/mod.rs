//! The problem file: its types as written and their conversion to a [`Task`](crate::control::problem::Task).
//!
//! - `motions`: several motions of one problem, each as a problem of its own.
//! - `build`: the problem; `control` (as written in `spec_control`), `simulation`, `identify`: its longer tasks; `channels`: what recordings measure; `changed_scenes`: scenes of some of them.
//! - `feedback`: gains along an optimum, and a controller that reads them; `receding`: a problem that it plans anew; `disturbance`: the same simulation with parts of its disturbance.
//! - `at`: places with their system; `state`, `end_of`, `quantities`, `free`, `sensitivity`, `loads`, `voltages`:
//!   their parts; `output`: what is written of a motion.

pub mod at;
pub mod build;
pub(crate) mod changed_scenes;
mod channels;
pub(crate) mod control;
pub(crate) mod disturbance;
mod end_of;
pub mod feedback;
pub mod free;
pub mod identify;
pub(crate) mod loads;
pub(crate) mod motions;
pub mod output;
pub mod quantities;
pub(crate) mod receding;
pub mod sensitivity;
pub mod simulation;
pub mod spec_control;
pub mod state;
pub mod voltages;
