//! Tasks in memory: simulate, optimise, refine, verify.
//!
//! - `integrate`, `optimise`: a simulation, and a control problem with its result, the `optimum`, by `stages` where contacts call for them; an
//!   `attempt` begins at one start and has one of the `solves` or more, until the objective is confirmed, of the `program` of one motion or
//!   several; `error`: errors of tasks; `remark`: warnings and notes.
//! - `grids`: on finer grids where an accuracy needs them or a verification fails, by `accuracy`; `tolerance`: steps as short as a tolerance needs.
//! - `resimulate`: verification of an optimum; `hold_check`: its end; `infeasible`: explanation of a problem without one.
//! - `effects`, `reasons`: terms of a model, what they couple, and their reasons; `memory`: a refusal of more than the machine has.
//! - `warnings`: steps that do not resolve a motion, muscles outside the domain of their material.
//! - `regulator`: feedback along an optimum; `receding`: a controller that plans anew; `control_loop`, `closed_loop`: a simulation under feedback.
//! - `tracking`: deviations of a motion from the references of its objective.
//! - `search`: a start for motions that touch, by simulations.
//! - `motion`: conversion between unknowns and a trajectory; `parallel_map`: pieces of work in several threads.

pub mod accuracy;
pub(crate) mod attempt;
pub mod closed_loop;
pub(crate) mod control_loop;
pub(crate) mod effects;
mod error;
pub(crate) mod grids;
pub(crate) mod hold_check;
pub(crate) mod infeasible;
pub(crate) mod integrate;
mod junction;
pub(crate) mod memory;
pub(crate) mod motion;
pub(crate) mod optimise;
pub(crate) mod optimum;
pub mod parallel_map;
pub(crate) mod program;
pub(crate) mod reasons;
pub mod receding;
pub mod regulator;
pub(crate) mod remark;
pub(crate) mod resimulate;
mod search;
mod solves;
mod stages;
pub(crate) mod tolerance;
pub(crate) mod tracking;
pub(crate) mod warnings;

pub use attempt::Together;
pub use effects::{EffectCounts, Plan, coupling, effect_counts};
pub use error::WorkflowError;
pub use grids::{ACCURACY, SolveRequest, optimise_together};
pub use hold_check::{Afterwards, Departure, Repeated};
pub use integrate::{Simulated, grid, integrate, integrate_on, integrate_to};
pub use motion::{Iterate, IterateMotions, solved, trajectory};
pub use optimise::optimise;
pub use optimum::{
    Active, Optimum, Restarted, Shortest, SolveLimits, Stages, Violation, WholeProgram, active,
    violations,
};
pub use program::Counted;
pub use reasons::{Absent, Cause, absent};
pub use remark::{Remark, Remarks, Severity, listen_to_phases};
pub use resimulate::Resimulation;
pub use tolerance::EstimatedError;
pub use tracking::{FinalValue, Tracked, TrackedPath, TrackingError, followed, tracked};
pub use warnings::{Outside, beyond, counted, divided};
