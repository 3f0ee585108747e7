//! What the program does with a problem file: solve, simulate, rest, inspect, check, and the files it leaves.
//!
//! - `solve`, `forward`, `rest`: the three tasks; `task` chooses what a file asks for.
//! - `motion`, `resimulate`, `violations`, `effects`, `reasons`, `stopwatch`, `blocks`: what is read from a scene or a result.
//! - `solution_file`, `summary`: the two JSON files; `fields`: those of elastic blocks; figures, tables and page are written by [`report`](crate::report).
//! - `inspect`, `spy`, `check`, `starter`: the other commands.

mod blocks;
mod check;
mod comparison;
mod effects;
mod error;
mod fields;
mod forward;
mod inspect;
mod motion;
mod path;
mod progress;
mod reasons;
mod request;
mod resimulate;
mod rest;
pub mod solution_file;
mod solve;
mod spy;
mod starter;
mod stopwatch;
mod summary;
mod task;
mod violations;

pub use blocks::{BlockSize, Blocks};
pub use check::check;
pub use effects::{EffectCounts, Plan, effect_counts};
pub use error::RunError;
pub use inspect::inspect;
pub use motion::{solved, trajectory};
pub use progress::Shown;
pub use reasons::{Absent, EFFECTS, absent};
pub use request::{Request, Told};
pub use rest::equilibrium_of_file;
pub use starter::{expand, new_trunk, schema};
pub use task::run;
pub use violations::{Violation, violations};
