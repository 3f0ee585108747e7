//! What the program does with a problem file: solve, simulate, rest, inspect, check, and the files it leaves.
//!
//! - `solve`, `forward`, `rest`: the three tasks; `task` chooses what a file asks for; `path`, `followed`: paths of equilibria.
//! - `optimise`, `integrate`: the first two in memory.
//! - `starts`: a control problem from several guesses, each in a process of its own; `memory`: what is more than the machine has.
//! - `grids`: solve and simulate as finely as an accuracy needs; `accuracy`, `estimate`: how that is found, `accuracy_table`: told.
//! - `resimulate`: what an optimum is worth, by the `distance` of motions; `cure`: finer grids where it is none; `holding`: its end.
//! - `second_start`, `infeasible`, `active`: what is tried before a problem is called infeasible, why it is, and which bounds it reaches.
//! - `motion`, `violations`, `effects`, `reasons`, `stopwatch`, `blocks`: what is read from a scene or a result.
//! - `solution_file`, `summary`: the two JSON files; `fields`: those of elastic blocks; figures, tables and page are written by [`report`](crate::report).
//! - `rest_observed`, `rest_refused`, `rest_words`, `words`, `folder`: what commands share.
//! - `inspect`, `spy`, `check`, `starter`: the other commands.

pub mod accuracy;
mod accuracy_table;
mod active;
mod blocks;
mod check;
mod comparison;
mod cure;
mod distance;
mod domain;
mod effects;
mod error;
pub mod estimate;
mod extent;
mod fields;
mod folder;
mod followed;
mod forward;
mod grids;
mod holding;
mod infeasible;
mod inspect;
mod integrate;
mod memory;
mod motion;
mod multistart;
mod optimise;
mod path;
mod progress;
mod reasons;
mod request;
mod resimulate;
mod rest;
mod rest_observed;
mod rest_refused;
mod rest_words;
mod second_start;
pub mod solution_file;
mod solve;
mod sparsity;
mod steps;
mod stopwatch;
mod summary;
mod task;
mod templates;
mod unfinished;
mod violations;
mod words;

pub use active::{Active, active};
pub use blocks::{BlockSize, BlockSizes};
pub use check::check;
pub use effects::{EffectCounts, Plan, effect_counts};
pub use error::RunError;
pub(crate) use folder::make_folder;
pub use grids::{integrate_to, optimise_to};
pub use inspect::inspect;
pub use integrate::{Simulated, grid, integrate};
pub use motion::{solved, trajectory};
pub use multistart::solve_from_starts;
pub use optimise::{Iterate, Optimum, SolveLimits, optimise};
pub use progress::ProgressDisplay;
pub(crate) use progress::progress_bar;
pub use reasons::{Absent, absent};
pub use request::{CommandInput, CommandOutput};
pub use resimulate::{Cause, Resimulation};
pub use rest::equilibrium_of_file;
pub use task::run;
pub use templates::{expand, new_trunk, schema, study_schema};
pub use violations::{Violation, violations};
