//! The problem file: its types as written (`spec`, `spec_*`) and their conversion to a [`Task`](crate::control::problem::Task).
//!
//! - `motions`: several motions of one problem, each as a problem of its own.
//! - `build`: the problem; `control`, `simulation`, `identify`: its longer tasks; `channels`, `channel_quantities`: what recordings measure; `changed_scenes`: scenes of some of them; `driven`: start and inputs of both motions.
//! - `feedback`: gains along an optimum, and a controller that reads them; `ahead`: a problem that it plans anew; `disturbance`: the same simulation with parts of its disturbance.
//! - `state`, `end_of`, `goal`, `limits`, `source_limits`, `free`, `guess`, `voltages`, `track`, `measured`, `energies`, `coordinates`: their parts; `output`: what is written of a motion; `solution_voltages`,
//!   `solution_joints`, `solution_document`:
//!   what is read of an earlier solution.

pub(crate) mod ahead;
mod amount_limits;
mod bounds;
pub(crate) mod build;
pub(crate) mod changed_scenes;
mod channel_quantities;
mod channels;
pub(crate) mod control;
pub(crate) mod coordinates;
pub(crate) mod disturbance;
pub(crate) mod driven;
mod end_of;
pub(crate) mod energies;
pub(crate) mod feedback;
pub(crate) mod free;
pub(crate) mod goal;
pub(crate) mod guess;
pub(crate) mod identify;
mod input_constants;
pub(crate) mod limits;
mod loads;
mod measured;
pub(crate) mod motions;
pub mod output;
mod priors;
mod reaction_limits;
mod sensitivity;
pub(crate) mod simulation;
pub(crate) mod solution_document;
pub(crate) mod solution_joints;
pub(crate) mod solution_voltages;
mod source_limits;
pub mod spec;
pub mod spec_amount_limits;
pub mod spec_control;
pub mod spec_coordinates;
pub mod spec_energies;
pub mod spec_feedback;
pub mod spec_free;
pub mod spec_identify;
pub mod spec_integrator;
pub mod spec_limits;
pub mod spec_measured;
pub mod spec_output;
pub mod spec_sensitivity;
pub mod spec_simulate;
pub mod spec_source_limits;
pub mod spec_states;
pub mod spec_track;
pub mod spec_voltages;
pub(crate) mod state;
pub(crate) mod track;
pub(crate) mod voltages;
pub(crate) mod waypoints;
