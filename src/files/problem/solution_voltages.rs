//! Voltages over time: from an earlier `solution.json`, or a table in the problem.

use serde::Deserialize;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use crate::control::problem::{Afterwards, Voltages};
use crate::files::json::error::Result;
use crate::files::json::scope::Scope;
use crate::files::problem::solution_document::solution_document;
use crate::files::problem::spec_voltages::TableSpec;
use crate::files::problem::state::{driven, voltages};
use crate::files::units::quantity::Quantity;
use crate::model::system::System;

/// Entries that are read of a solution.
#[derive(Debug, Deserialize)]
struct SolutionRecord {
    /// Instants in s.
    time: Vec<f64>,
    /// Voltages in V by source, one per interval.
    voltages: BTreeMap<String, Vec<f64>>,
    /// Voltages in V by source that hold the goal; a motion without a goal, or with one whose voltages are not known, has none.
    #[serde(default)]
    hold: Option<BTreeMap<String, f64>>,
}

/// Voltages of a solution, then those that hold its goal, or where it names none the last ones; 0 for sources that it does
/// not know.
pub(crate) fn of_solution(path: &Path, system: &System) -> Result<Voltages> {
    let document =
        &solution_document(path, |name| name == "time" || name.starts_with("voltages/"))?;
    let solution: SolutionRecord = document.parse()?;
    let scope = Scope::of(document);
    let instants: Vec<f64> = solution.time.iter().map(|time| 1e3 * time).collect();
    let all_series = solution.voltages.iter();
    let all_series = all_series.map(|(name, series)| (name, series.iter().copied()));
    let rows = rows(&instants, all_series, system, &scope)?;
    let hold = match &solution.hold {
        Some(hold) => {
            let sources = system.sources();
            let mut row = vec![0.0; sources.len()];
            for (name, &voltage) in hold {
                row[driven(name, &sources, &scope.key("hold").key(name))?] = voltage;
            }
            Some(row)
        }
        None => None,
    };
    Ok(sampled(instants, rows, hold, Some(path.to_owned())))
}

/// Voltages of a table, then those that it says are held, or the last ones; 0 for sources that it does not name.
pub(crate) fn of_table(table: &TableSpec, system: &System, scope: &Scope<'_>) -> Result<Voltages> {
    let instants: Vec<f64> = table.time.iter().map(|time| time.value()).collect();
    let all_series = table.voltages.iter();
    let all_series = all_series.map(|(name, series)| (name, series.iter().map(Quantity::value)));
    let rows = rows(&instants, all_series, system, scope)?;
    if instants[0] != 0.0 {
        let found = format!("{} s", instants[0] / 1e3);
        return Err(scope.key("time").index(0).wrong(found, "0"));
    }
    let hold = match &table.hold {
        Some(hold) => Some(voltages(hold, system, &scope.key("hold"))?),
        None => None,
    };
    Ok(sampled(instants, rows, hold, None))
}

/// A row of voltages for each interval between instants in ms, and one of zeros for what follows.
fn rows<'a>(
    instants: &[f64],
    all_series: impl Iterator<Item = (&'a String, impl ExactSizeIterator<Item = f64>)>,
    system: &System,
    scope: &Scope<'_>,
) -> Result<Vec<Vec<f64>>> {
    let place = scope.key("time");
    if instants.len() < 2 {
        let found = format!("{} instants", instants.len());
        return Err(place.wrong(found, "2 instants or more"));
    }
    place.increasing(instants)?;
    let intervals = instants.len() - 1;
    let sources = system.sources();
    let mut rows = vec![vec![0.0; sources.len()]; intervals + 1];
    for (name, series) in all_series {
        let place = scope.key("voltages").key(name);
        let source = driven(name, &sources, &place)?;
        if series.len() != intervals {
            let found = format!("{} voltages", series.len());
            let expected = format!("{intervals}, one per interval");
            return Err(place.wrong(found, expected));
        }
        for (row, voltage) in rows.iter_mut().zip(series) {
            row[source] = voltage;
        }
    }
    Ok(rows)
}

/// Rows of voltages, the last one those afterwards.
fn sampled(
    mut instants: Vec<f64>,
    mut rows: Vec<Vec<f64>>,
    hold: Option<Vec<f64>>,
    solution: Option<PathBuf>,
) -> Voltages {
    let afterwards = match hold {
        Some(_) => Afterwards::Held,
        None => Afterwards::OfLastInterval,
    };
    let end = rows.len() - 1;
    rows[end] = hold.unwrap_or_else(|| rows[end - 1].clone());
    instants.remove(0);
    Voltages::Sampled {
        ends: instants,
        rows,
        afterwards,
        solution,
        others: BTreeMap::new(),
    }
}
