//! Results in their folders: what is kept, found again and gone on from.
//!
//! - `solution_file`: `solution.json`. `record`, `cache`: hashes of the files of a result, and a result that is made once.
//! - `unfinished`, `partial_result`, `resume_file`: what a stopped run leaves, and runs that go on from it.
//! - `overwrite_check`: results of another problem in the folder.

pub(super) mod cache;
pub(super) mod overwrite_check;
pub(super) mod partial_result;
pub(super) mod record;
pub(super) mod resume_file;
pub(super) mod solution_file;
pub(super) mod unfinished;
