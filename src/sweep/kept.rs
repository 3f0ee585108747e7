//! What a solved variant leaves in its folder: `variant.json`, written last, and the numbers of its results.

use std::fs;
use std::path::Path;

use csv::ReaderBuilder;
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

use crate::app::{CommandError, RunEnd, Said, make_folder};
use crate::files::lay_out;
use crate::report::atomic;
use crate::sweep::read::Variant;

/// The file.
const NAME: &str = "variant.json";
/// Begins the headings of numbers at the end of a motion, or at rest.
pub(super) const END: &str = "end: ";
/// What can be otherwise the next time.
const UNFINISHED: [&str; 5] = [
    "not_started",
    "interrupted",
    "time_limit",
    "failed",
    "out_of_memory",
];

/// How a variant ended.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Kept {
    /// Overrides.
    pub(super) set: Vec<String>,
    pub(super) identity: String,
    /// The word of its summary; `refused` where the input is wrong, `failed` where it broke off.
    pub(super) status: String,
    /// Whether its question has an answer.
    pub(super) is_solved: bool,
    /// What was said where it left no summary.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(super) message: Option<String>,
    /// Wall time in s.
    pub(super) seconds: f64,
    /// Numbers of its results, by the heading of their column.
    pub(super) numbers: Map<String, Value>,
}

#[derive(Deserialize)]
struct Summary {
    status: String,
    #[serde(default)]
    objective: Option<f64>,
    #[serde(default)]
    iterations: Option<usize>,
}

impl Kept {
    /// How the variant ended that said this; the files of its solve are in `folder`.
    pub(super) fn of(variant: &Variant, end: &RunEnd, folder: &Path) -> Self {
        let (word, message) = match &end.said {
            Said::NotStarted => ("not_started", None),
            Said::Solved => ("solved", None),
            Said::Unsolved(message) => ("failed", Some(message)),
            Said::Failed(message) => ("failed", Some(message)),
            Said::Refused(message) => ("refused", Some(message)),
        };
        let mut kept = Self {
            set: variant.set.clone(),
            identity: variant.identity.as_str().to_owned(),
            status: word.to_owned(),
            is_solved: end.said == Said::Solved,
            message: message.filter(|text| !text.is_empty()).cloned(),
            seconds: end.seconds,
            numbers: Map::new(),
        };
        if matches!(end.said, Said::Solved | Said::Unsolved(_)) {
            kept.read_results(folder);
        }
        kept
    }

    /// A variant whose problem is refused.
    pub(super) fn refused(variant: &Variant, message: &str) -> Self {
        let said = Said::Refused(message.to_owned());
        let end = RunEnd { said, seconds: 0.0 };
        Self::of(variant, &end, Path::new(""))
    }

    /// What the folder of a variant holds, if that is the end of this variant and nothing is left to do.
    pub(super) fn read(variant: &Variant, folder: &Path) -> Option<Self> {
        let text = fs::read_to_string(folder.join(NAME)).ok()?;
        let kept: Self = serde_json::from_str(&text).ok()?;
        let is_it = kept.identity == variant.identity.as_str();
        (is_it && !kept.is_unfinished()).then_some(kept)
    }

    /// Whether another attempt may end otherwise.
    pub(super) fn is_unfinished(&self) -> bool {
        UNFINISHED.contains(&self.status.as_str())
    }

    /// Writes it into the folder of the variant.
    pub(super) fn write(&self, folder: &Path) -> Result<(), CommandError> {
        make_folder(folder)?;
        let text = serde_json::to_string(self).expect("words and numbers are JSON");
        Ok(atomic::write(
            &folder.join(NAME),
            lay_out(&text).as_bytes(),
        )?)
    }

    fn read_results(&mut self, folder: &Path) {
        let summary = fs::read_to_string(folder.join("summary.json")).ok();
        let Some(summary) = summary.and_then(|text| serde_json::from_str::<Summary>(&text).ok())
        else {
            return;
        };
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
