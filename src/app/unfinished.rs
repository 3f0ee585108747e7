//! What a long run has found so far, kept for the case that it is killed.

use std::fs;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use crate::app::solution_file;
use crate::control::Solution;
use crate::model::Model;

/// Name of the file; it has the format of `solution.json`.
const NAME: &str = "unfinished.json";
/// Shortest time between two writings.
const PERIOD: Duration = Duration::from_secs(2);
/// No more than one part in so many of the time goes into writing.
const SHARE: u32 = 20;
/// A point of no greater violation is as good as one that meets equations and limits.
const MEETS: f64 = 1e-6;

/// The file in the folder of the results, written anew now and then, and removed when the results are complete.
#[derive(Debug)]
pub(super) struct Unfinished {
    path: PathBuf,
    /// When it may be written next.
    next: Instant,
    /// Violation of the point in the file.
    violation: f64,
}

impl Unfinished {
    /// Nothing is written yet; the first time comes after two seconds.
    pub(super) fn of(folder: &Path) -> Self {
        Self {
            path: folder.join(NAME),
            next: Instant::now() + PERIOD,
            violation: f64::INFINITY,
        }
    }

    /// Writes a motion, when it is time and it is as good as the one that was written: `violation` is that of its equations and
    /// limits.
    pub(super) fn consider(
        &mut self,
        model: &Model,
        violation: f64,
        motion: impl FnOnce() -> Solution,
    ) {
        let began = Instant::now();
        if began < self.next || violation > self.violation.max(MEETS) {
            return;
        }
        match solution_file::write(&self.path, model, &motion()) {
            Ok(()) => self.violation = violation,
            // The results of the whole run are written to the same folder, and tell it then.
            Err(error) => tracing::warn!("{error}"),
        }
        self.next = Instant::now() + PERIOD.max(SHARE * began.elapsed());
    }

    /// The results are complete: nothing is unfinished, of this run or an earlier one.
    pub(super) fn done(self) {
        fs::remove_file(self.path).ok();
    }
}
