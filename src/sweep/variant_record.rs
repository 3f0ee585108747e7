//! Record of a solved variant in its folder: `variant.json`, written last, and the numbers of its results.

use std::path::Path;

use csv::ReaderBuilder;
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

use crate::app::{
    FileRecords, FolderRecord, OF_VARIANT, RunEnd, Said, WrittenSummary, is_unfinished,
};
use crate::sweep::read::Variant;

/// Begins the headings of numbers at the end of a motion, or at rest.
pub(super) const END: &str = "end: ";
/// Record of a variant.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct VariantRecord {
    /// Overrides.
    pub(super) set: Vec<String>,
    pub(super) identity: String,
    /// The word of its summary; `refused` where the input is wrong, `failed` where it broke off.
    pub(super) status: String,
    /// True if its question has an answer.
    pub(super) is_solved: bool,
    /// Message where it left no summary.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(super) message: Option<String>,
    /// Wall time in s.
    pub(super) seconds: f64,
    /// Numbers of its results, by the heading of their column.
    pub(super) numbers: Map<String, Value>,
    /// The files of its folder as they were written.
    #[serde(default)]
    files: FileRecords,
    /// True if a stop kept it from a better result.
    #[serde(skip)]
    is_stopped_early: bool,
}

impl VariantRecord {
    /// Makes the record of a variant that ended with this; the files of its solve are in `folder`.
    pub(super) fn from_end(variant: &Variant, end: &RunEnd, folder: &Path) -> Self {
        let word = match &end.said {
            Said::NotStarted => "not_started",
            Said::Solved => "solved",
            Said::Unsolved(_) | Said::Failed(_) => "failed",
            Said::Refused(_) => "refused",
        };
        let mut kept = Self {
            set: variant.set.clone(),
            identity: variant.identity.as_str().to_owned(),
            status: word.to_owned(),
            is_solved: end.said == Said::Solved,
            message: end.message(),
            seconds: end.seconds,
            numbers: Map::new(),
            files: FileRecords::default(),
            is_stopped_early: false,
        };
        if let Some(summary) = end.summary(folder) {
            kept.read_results(summary, folder);
        }
        kept
    }

    /// A variant whose problem is refused.
    pub(super) fn refused(variant: &Variant, message: &str) -> Self {
        let said = Said::Refused(message.to_owned());
        let end = RunEnd { said, seconds: 0.0 };
        Self::from_end(variant, &end, Path::new(""))
    }

    /// Returns true if another attempt may end otherwise.
    pub(super) fn is_unfinished(&self) -> bool {
        is_unfinished(&self.status) || self.is_stopped_early
    }

    fn read_results(&mut self, summary: WrittenSummary, folder: &Path) {
        self.is_stopped_early = summary.is_unfinished();
        self.status = summary.status;
        self.message = None;
        let objective = summary.objective.map(Value::from);
        let iterations = summary.iterations.map(Value::from);
        let own = [("objective", objective), ("iterations", iterations)];
        let own = own.into_iter();
        let own = own.filter_map(|(name, value)| Some((name.to_owned(), value?)));
        self.numbers.extend(own);
        for table in ["trajectory.csv", "equilibrium.csv"] {
            self.numbers.extend(last_row(&folder.join(table)));
        }
    }
}

impl FolderRecord for VariantRecord {
    const NAME: &'static str = OF_VARIANT;

    fn identity(&self) -> &str {
        &self.identity
    }

    fn files(&mut self) -> &mut FileRecords {
        &mut self.files
    }
}

/// The numbers of the last row of a table, by their headings.
fn last_row(table: &Path) -> Vec<(String, Value)> {
    let reader = ReaderBuilder::new().comment(Some(b'#')).from_path(table);
    let Ok(mut reader) = reader else {
        return Vec::new();
    };
    let headers = reader.headers().cloned().unwrap_or_default();
    let Some(Ok(last)) = reader.records().last() else {
        return Vec::new();
    };
    let pairs = headers.iter().zip(last.iter());
    let numbers = pairs.filter_map(|(name, cell)| {
        let number: f64 = cell.parse().ok()?;
        Some((format!("{END}{name}"), Value::from(number)))
    });
    numbers.collect()
}
