//! Errors of discretisation in words: a line for each grid, and the outcome.

use crate::workflow::accuracy::{Accuracy, GridLevel};
use crate::workflow::estimate::greatest;

/// Errors that have a column, where a run has them.
const COLUMNS: [&str; 5] = ["objective", "duration", "path", "end", "response"];

impl Accuracy {
    /// The grids as a table, one line each, and why there is no finer one.
    pub(super) fn notes(&self) -> Vec<String> {
        let has_objective = self.levels[0].objective.is_some();
        let is_estimated =
            |name: &&&str| self.levels.iter().any(|l| l.estimate.contains_key(**name));
        let columns: Vec<&str> = COLUMNS.iter().filter(is_estimated).copied().collect();
        let mut head = "intervals  iterations   seconds".to_owned();
        if has_objective {
            head.push_str("     objective");
        }
        for (i, name) in columns.iter().enumerate() {
            let lead = if i == 0 { "  error of " } else { "" };
            head.push_str(&format!("{lead}{name:>10}"));
        }
        let line = |level: &GridLevel| {
            let (n, i) = (level.intervals, level.iterations);
            let mut line = format!("{n:>9}{i:>12}{:>10.2}", level.seconds);
            if let Some(objective) = level.objective {
                line.push_str(&format!("{objective:>14.7}"));
            }
            for (i, name) in columns.iter().enumerate() {
                let lead = if i == 0 { "           " } else { "" };
                let error = level.estimate.get(name);
                let error = error.map_or(String::new(), |e| format!("{e:.1e}"));
                line.push_str(&format!("{lead}{error:>10}"));
            }
            line.trim_end().to_owned()
        };
        let lines = self.levels.iter().map(line);
        let mut notes: Vec<String> = std::iter::once(head).chain(lines).collect();
        let orders: Vec<String> = self
            .order
            .iter()
            .map(|(name, p)| format!("{name} {p:.2}"))
            .collect();
        if !orders.is_empty() {
            notes.push(format!("orders observed: {}", orders.join(", ")));
        }
        let grows = |(name, p): (&&str, &f64)| (*p <= 0.0).then(|| (*name).to_owned());
        let growing: Vec<String> = self.order.iter().filter_map(grows).collect();
        if !growing.is_empty() {
            notes.push(format!(
                "the last refinement changed {} no less than the one before: errors do not fall steadily, their estimates are rough",
                growing.join(" and ")
            ));
        }
        notes.extend(self.stopped.as_deref().map(|word| match word {
            "too_large" => "no finer grid is tried: it would be too large".to_owned(),
            "time_limit" => "no finer grid: the time allowed was used up".to_owned(),
            "interrupted" => "no finer grid: interrupted".to_owned(),
            other => format!("no finer grid: {}", other.replace('_', " ")),
        }));
        notes
    }

    /// The accuracy of a run that is `done` ("solved", "simulated"), in words, and true if that is what was asked for.
    pub(super) fn outcome(&self, done: &str) -> (String, bool) {
        let error = greatest(&self.estimate);
        let of = |(name, error): (&str, f64)| format!("{error:.1e} ({name})");
        match (self.requested, error) {
            (None, Some(found)) => (format!("{done}, error about {}", of(found)), true),
            (None, None) => (format!("{done}, error not known"), true),
            (Some(_), Some(found)) if self.is_met == Some(true) => {
                (format!("{done}, error about {}", of(found)), true)
            }
            (Some(asked), Some(found)) => {
                let found = of(found);
                (
                    format!("{done}, but not to {asked:e}: error about {found}"),
                    false,
                )
            }
            (Some(asked), None) => (
                format!("{done}, but not to {asked:e}: error not known"),
                false,
            ),
        }
    }
}
