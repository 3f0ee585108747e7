//! Results in their folders: what is kept, found again and gone on from.
//!
//! - `solution_file`: `solution.json`. `record`, `cache`: the result that a folder has with hashes of its files, and a result that is made once.
//! - `unfinished`, `resume_file`: what a stopped run leaves, and runs that go on from it.

pub(super) mod cache;
pub(super) mod record;
pub(super) mod resume_file;
pub(super) mod solution_file;
pub(super) mod unfinished;
