//! End of a variant: that of its run, and the numbers of its results.

use std::path::Path;

use csv::ReaderBuilder;
use serde_json::{Map, Value};

use crate::app::Ended;

/// Begins the headings of numbers at the end of a motion, or at rest.
pub(super) const END: &str = "end: ";

/// End of a variant.
#[derive(Debug)]
pub(super) struct VariantEnd {
    pub(super) ended: Ended,
    /// Numbers of its results, by the heading of their column.
    pub(super) numbers: Map<String, Value>,
}

impl VariantEnd {
    /// Reads what a run left in the folder of its variant.
    pub(super) fn new(ended: Ended) -> Self {
        let summary = &ended.summary;
        let objective = summary.objective.map(Value::from);
        let iterations = summary.iterations.map(Value::from);
        let own = [("objective", objective), ("iterations", iterations)];
        let own = own.into_iter();
        let own = own.filter_map(|(name, value)| Some((name.to_owned(), value?)));
        let mut numbers: Map<String, Value> = own.collect();
        if let Some(folder) = &ended.folder {
            for table in ["trajectory.csv", "equilibrium.csv"] {
                numbers.extend(last_row(&folder.join(table)));
            }
        }
        Self { ended, numbers }
    }

    /// One that has no results.
    pub(super) fn without_results(status: &str, message: &str) -> Self {
        Self::new(Ended::without_results(status, message.to_owned(), 0.0))
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
