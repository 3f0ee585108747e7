//! A path of equilibria in `summary.json`.

use serde::Serialize;

use crate::dynamics::{Continuation, Instability};

/// A path in `summary.json`.
#[derive(Debug, Serialize)]
pub(super) struct PathSummary {
    /// Number of equilibria.
    points: usize,
    /// Largest fraction of the voltages on the path: of these equilibria and of those where stability is lost between them.
    largest_fraction: f64,
    /// Points at which stability is lost.
    pub(super) lost: Vec<StabilityLossRecord>,
}

/// A loss of stability.
#[derive(Debug, Serialize)]
pub(super) struct StabilityLossRecord {
    /// Exact fraction of the voltages.
    pub(super) fraction: f64,
    /// `pull_in` or `buckling`.
    kind: &'static str,
    /// The same in words.
    #[serde(skip)]
    pub(super) words: &'static str,
}

impl PathSummary {
    pub(super) fn new(found: &Continuation) -> Self {
        let loss = |&(_, fraction, kind): &(usize, f64, Instability)| StabilityLossRecord {
            fraction,
            kind: kind.key(),
            words: kind.words(),
        };
        let lost = found.lost.iter().map(|&(_, fraction, _)| fraction);
        let all = found.fractions.iter().copied().chain(lost);
        Self {
            points: found.points.len(),
            largest_fraction: all.fold(0.0, f64::max),
            lost: found.lost.iter().map(loss).collect(),
        }
    }

    /// Rows of the page; `shown` is the fraction of the voltages of the equilibrium that is drawn.
    pub(super) fn rows(&self, shown: f64) -> Vec<(String, String)> {
        let mut rows = vec![
            ("equilibria".to_owned(), self.points.to_string()),
            (
                "largest fraction of the voltages".to_owned(),
                format!("{:.6} %", 100.0 * self.largest_fraction),
            ),
        ];
        rows.extend(self.lost.iter().map(|loss| {
            let place = format!("{:.6} % of the voltages", 100.0 * loss.fraction);
            (loss.words.to_owned(), place)
        }));
        let place = format!("the equilibrium at {:.6} %", 100.0 * shown);
        rows.push(("configuration".to_owned(), place));
        rows
    }
}
