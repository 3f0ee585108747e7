//! Commands: files in, files and messages out.
//!
//! - `solve`, `motions`, `simulation`, `equilibrium`, `identification`: the tasks; `task` chooses the one of a file; `path`: paths of equilibria.
//! - `batch`: several solves in parallel, in threads or processes; `multistart`: a control problem from several guesses.
//! - `inspect`, `templates`: the other commands; `program`: entry points for other languages in place of files.
//! - `solution_file`, `summary`: JSON files; `feedback_files`, `fields`: those of gains and of elastic blocks; figures, tables and page are written by [`report`](crate::report).
//! - `unfinished`, `partial_result`, `resume_file`: what a stopped run leaves, and runs that go on from it.
//! - `cache`, `record`: a result that is made once, and the hashes of its files.
//! - `displayed_motion`: part of a motion that tables, figures and page show.
//! - `blocks`, `comparison`, `linear_systems`, `solve_summary`, `equilibrium_summary`, `sensitivity_summary`, `identification_summary`, `identification_verdict`,
//!   `no_equilibrium`: texts about a result.
//! - `overwrite_check`, `progress`, `request`, `error`: common parts of commands.

mod batch;
mod blocks;
mod cache;
mod comparison;
mod displayed_motion;
mod equilibrium;
mod equilibrium_summary;
mod error;
mod feedback_files;
mod fields;
mod identification;
mod identification_summary;
mod identification_verdict;
mod inspect;
mod linear_systems;
mod motions;
mod multistart;
mod no_equilibrium;
mod overwrite_check;
mod partial_result;
mod path;
mod program;
mod progress;
mod record;
mod request;
mod resume_file;
mod sensitivity_summary;
mod simulation;
mod solution_file;
mod solve;
mod solve_summary;
mod summary;
mod task;
mod templates;
mod unfinished;

pub(crate) use batch::{Batch, RunEnd, Said, check_run_in, run_all, task_runs_at_once};
pub use batch::{RunIn, end_with_parent};
pub use blocks::{BlockSize, BlockSizes};
pub(crate) use cache::Identity;
pub use cache::run_once;
pub use equilibrium::equilibrium_of_file;
pub use error::CommandError;
pub use inspect::{Inspected, inspect, inspected};
pub use motions::compare;
pub use multistart::{solve_from_starts, solve_text_from_starts};
pub(crate) use overwrite_check::{make_folder, without_dots};
pub use program::{
    FileHorizon, SiController, changed_text, check, check_text, checked, with_program,
};
pub(crate) use progress::{Progress, progress_bar};
pub use progress::{ProgressDisplay, Reached};
pub(crate) use record::{Ending, FileRecords, FolderRecord, Found, OF_VARIANT, is_unfinished};
pub use request::{CommandInput, CommandOutput, PageWanted};
pub use summary::written_summary;
pub use task::{run, run_observed, simulate};
pub use templates::{
    Template, expand, materials, new_files, new_from_urdf, schema, study_schema, sweep_schema,
    write_file,
};
