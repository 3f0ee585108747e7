//! Commands: files in, files and messages out.
//!
//! - `solve`, `simulation`, `equilibrium`, `identification`: the tasks; `task` chooses the one of a file.
//! - `batch`: several solves in parallel, in threads or processes; `multistart`: a control problem from several guesses.
//! - `inspect`, `templates`: the other commands; `program`: entry points for other languages in place of files.
//! - `kept`: results in their folders, found again and gone on from.
//! - `summary`: `summary.json`; `feedback_files`, `fields`: files of gains and of elastic blocks; [`report`](crate::report) writes figures, tables and
//!   page.
//! - `displayed_motion`: part of a motion that tables, figures and page show.
//! - `blocks`, `comparison`, `linear_systems`, `solve_summary`, `equilibrium_summary`, `identification_summary`: texts about a result;
//!   `vibrations`: its vibrations.
//! - `progress`, `request`, `error`: common parts of commands.

mod batch;
mod blocks;
mod comparison;
mod displayed_motion;
mod equilibrium;
mod equilibrium_summary;
mod error;
mod feedback_files;
mod fields;
mod identification;
mod identification_summary;
mod inspect;
mod kept;
mod linear_systems;
mod multistart;
mod program;
mod progress;
mod request;
mod simulation;
mod solve;
mod solve_summary;
mod summary;
mod task;
mod templates;
mod vibrations;

pub(crate) use batch::{Batch, Ended, check_run_in, run_all, task_runs_at_once};
pub use batch::{RunIn, end_with_parent};
pub use equilibrium::equilibrium_of_file;
pub use error::CommandError;
pub use inspect::{Inspected, inspect, inspected};
pub use kept::cache::run_once;
pub(crate) use kept::cache::{found, identity, identity_of_words};
pub(crate) use kept::record::{make_folder, without_dots};
pub use multistart::solve_from_starts;
pub use program::{
    FileHorizon, SiController, changed_text, check, check_text, checked, with_program,
};
pub(crate) use progress::progress_bar;
pub use progress::{ProgressDisplay, Reached};
pub use request::{CommandInput, CommandOutput, PageWanted};
pub use solve::compare;
pub use summary::written_summary;
pub use task::{run, run_observed, simulate};
pub use templates::{
    Template, expand, materials, new_files, new_from_urdf, schema, study_schema, sweep_schema,
    write_file,
};
