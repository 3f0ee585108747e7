//! Tasks in memory: simulate, optimise, refine, verify.
//!
//! - `integrate`, `optimise`: a simulation, a control problem, with its result, the `optimum`; each `attempt` from one start by one of its `solves` or more; `resolve`: its model and boundary; `error`: errors of tasks;
//!   `remark`: warnings and notes.
//! - `program_motion`, `prepare_together`: one or several motions as one program, with `shared_variables`.
//! - `grids`: on finer grids where an accuracy needs them or a verification fails, by `accuracy` and `estimate`; `tolerance`: steps as short as a tolerance needs.
//! - `resimulate`: verification of an optimum, by the `distance` of motions; `gap`: duality gap of its
//!   objective; `held`, `hold_check`, `period`: its end; `repeat`: simulations with several steps for each interval.
//! - `restarts`, `retry_displaced`, `shortest`, `infeasible`, `active`: attempts before a problem is called infeasible, and the explanation.
//! - `effects`, `coupled`, `reasons`: terms of a model, what they couple, and their reasons; `memory`: a refusal of more than the machine has.
//! - `steps`, `domain`: warnings of a motion: steps that do not resolve it, muscles outside the domain of their material; `longer_steps`: the error of
//!   methods of high order.
//! - `regulator`: feedback along an optimum; `receding`: a controller that plans anew; `control_loop`, `closed_loop`, `loop_limits`: a simulation under feedback.
//! - `tracking`: deviations of a motion from the references of its objective.
//! - `motion`: conversion between unknowns and a trajectory; `parallel_map`: pieces of work in several threads.

pub mod accuracy;
pub(crate) mod active;
pub(crate) mod attempt;
pub mod closed_loop;
pub(crate) mod control_loop;
pub(crate) mod coupled;
pub(crate) mod distance;
pub(crate) mod domain;
pub(crate) mod effects;
mod error;
pub mod estimate;
pub(crate) mod gap;
pub(crate) mod grids;
pub(crate) mod held;
pub(crate) mod hold_check;
pub(crate) mod infeasible;
pub(crate) mod integrate;
pub(crate) mod longer_steps;
pub(crate) mod loop_limits;
pub(crate) mod memory;
pub(crate) mod motion;
pub(crate) mod optimise;
pub(crate) mod optimum;
pub mod parallel_map;
pub(crate) mod period;
pub(crate) mod prepare_together;
mod program_motion;
pub(crate) mod reasons;
pub mod receding;
pub mod regulator;
pub(crate) mod remark;
pub(crate) mod repeat;
pub(crate) mod resimulate;
pub(crate) mod resolve;
pub(crate) mod restarts;
pub(crate) mod retry_displaced;
mod shared_variables;
pub(crate) mod shortest;
mod solves;
pub(crate) mod steps;
pub(crate) mod tolerance;
pub(crate) mod tracking;

pub use active::{Active, active};
pub use active::{Violation, violations};
pub use domain::Outside;
pub use effects::{EffectCounts, Plan, coupling, effect_counts};
pub use error::WorkflowError;
pub use grids::{ACCURACY, SolveRequest, Together, optimise_together};
pub use hold_check::{Afterwards, Departure};
pub use integrate::{Simulated, grid, integrate, integrate_on, integrate_to};
pub use motion::{Iterate, IterateMotions};
pub use motion::{solved, trajectory};
pub use optimise::optimise;
pub use optimum::{Optimum, Restarted, Shortest, SolveLimits, WholeProgram};
pub use period::Repeated;
pub use prepare_together::Counted;
pub use reasons::Cause;
pub use reasons::{Absent, absent};
pub use remark::listen_to_phases;
pub use remark::{Remark, Remarks, Severity};
pub use resimulate::{Resimulation, under_constant_voltages};
pub use steps::{beyond, counted, divided};
pub use tolerance::EstimatedError;
pub use tracking::FinalValue;
pub use tracking::{Tracked, TrackedPath, TrackingError, followed, tracked};
