//! Electrical energy and mechanical work of a motion in `summary.json` and on the page.

use serde::Serialize;

use crate::dynamics::EnergyExchange;
use crate::math::significant;

/// Sums over all sources from the start to the end of a motion, in J.
#[derive(Debug, Serialize)]
pub(super) struct EnergySummary {
    /// Electrical energy from the sources.
    electrical_energy: f64,
    /// Work of the electrical forces.
    mechanical_work: f64,
}

impl EnergySummary {
    /// Of a motion; none without sources, or where one drives finite elements.
    pub(super) fn new(exchange: &EnergyExchange) -> Option<Self> {
        let last = |sums: Vec<f64>| sums.last().copied().unwrap_or(0.0) / 1e3;
        let [electrical_energy, mechanical_work] = exchange.totals()?.map(last);
        Some(Self {
            electrical_energy,
            mechanical_work,
        })
    }

    /// Rows of the table of the page.
    pub(super) fn rows(&self) -> [(String, String); 2] {
        let row = |name: &str, energy: f64| {
            let value = format!("{} mJ", significant(1e3 * energy, 5));
            (name.to_owned(), value)
        };
        [
            row("electrical energy from the sources", self.electrical_energy),
            row(
                "mechanical work of the electrical forces",
                self.mechanical_work,
            ),
        ]
    }
}
