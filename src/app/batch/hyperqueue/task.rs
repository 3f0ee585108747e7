//! End of a task of HyperQueue.

use std::fs;
use std::path::Path;

use serde::Deserialize;
use serde_json::Value;

use crate::app::batch::end::{RunEnd, Said, of_status};

/// Task as the server reports it.
#[derive(Debug, Deserialize)]
pub(super) struct Task {
    /// Its number in the job.
    pub(super) id: usize,
    state: String,
    /// Reason why it failed.
    #[serde(default)]
    error: Option<String>,
}

impl Task {
    /// Returns true if it has ended for good.
    pub(super) fn has_ended(&self) -> bool {
        !matches!(self.state.as_str(), "waiting" | "running")
    }

    /// Returns its end, with what it wrote to standard error in the file `standard_error`, and its results in `folder`; none where it was
    /// cancelled.
    pub(super) fn end(&self, standard_error: &Path, folder: &Path) -> Option<RunEnd> {
        let words = fs::read_to_string(standard_error).unwrap_or_default();
        let said = match (self.state.as_str(), self.exit_status()) {
            ("finished", _) => Said::Solved,
            ("failed", Some(status)) => of_status(Some(status), &words),
            ("failed", None) => Said::Failed(self.error.clone().unwrap_or(words)),
            _ => return None,
        };
        Some(RunEnd {
            said,
            seconds: seconds(folder),
        })
    }

    /// The exit status that is in the words of the server; none where a signal ended it, or its worker was lost.
    fn exit_status(&self) -> Option<i32> {
        let (_, after) = self.error.as_ref()?.split_once("exit code ")?;
        let end = after.find(|c: char| !c.is_ascii_digit());
        after[..end.unwrap_or(after.len())].parse().ok()
    }
}

/// Wall time in s that a solve wrote into its summary.
fn seconds(folder: &Path) -> f64 {
    let text = fs::read_to_string(folder.join("summary.json")).unwrap_or_default();
    let summary: Value = serde_json::from_str(&text).unwrap_or_default();
    let total = summary.pointer("/seconds/total");
    total.and_then(Value::as_f64).unwrap_or(0.0)
}
