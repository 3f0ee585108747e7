//! Request of the command `study`.

use std::path::PathBuf;

use crate::app::ProgressDisplay;

/// A command on a study file.
#[derive(Clone, Debug)]
pub struct StudyRequest {
    /// The command as typed.
    pub command: String,
    /// The study file as typed.
    pub input: PathBuf,
    /// Folder for the results; `results/studies/<name of the study>` where not given.
    pub output: Option<PathBuf>,
    /// Timed runs of each point, in place of those of the file.
    pub runs: Option<usize>,
    /// Display of progress.
    pub progress: ProgressDisplay,
}

impl StudyRequest {
    /// Folder for the results.
    pub fn folder(&self) -> PathBuf {
        self.output.clone().unwrap_or_else(|| {
            let stem = self.input.file_stem().unwrap_or_default();
            PathBuf::from("results/studies").join(stem)
        })
    }
}
