//! Voltages over time: by the names of sources, from an earlier `solution.json`, or a table in the problem.

use serde::Deserialize;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use crate::control::problem::{Afterwards, Voltages};
use crate::files::json::document::Document;
use crate::files::json::scope::{Result, Scope, refuse};
use crate::files::problem::at::At;
use crate::files::problem::spec_voltages::{TableSpec, VoltagesSpec};
use crate::files::signal::signal;
use crate::files::signal::spec::SignalSpec;
use crate::files::solution::complete;
use crate::files::units::quantity::{Quantity, Voltage};
use crate::math::Signal;
use crate::model::system::System;

/// Expected value of a path to an earlier result.
pub(crate) const SOLUTION_PATH: &str =
    "the path of a solution.json, or of the folder that holds it";

/// Voltages of a simulation.
pub(crate) fn over_time(spec: &VoltagesSpec, at: &At<'_>) -> Result<Voltages> {
    match spec {
        VoltagesSpec::Signals(map) => signals(map, at),
        VoltagesSpec::Solution(solution) => {
            let place = at.key("solution");
            let path = place.solution_file(&solution.solution, SOLUTION_PATH)?;
            of_solution(&path, at.system)
        }
        VoltagesSpec::Table(table) => of_table(table, at),
    }
}

/// Voltages by the names of sources; constant ones where all of them are.
pub(crate) fn signals(
    map: &BTreeMap<String, SignalSpec<Voltage>>,
    at: &At<'_>,
) -> Result<Voltages> {
    let mut signals = vec![Signal::Constant(0.0); at.sources.len()];
    for (name, spec) in map {
        let at = at.key(name);
        signals[at.driven(name)?] = signal(spec, &Voltage::kind(), &at)?;
    }
    Ok(Voltages::of_signals(signals))
}

/// An earlier `solution.json` with those of its arrays that are wanted, wherever they stand.
pub(crate) fn solution_document(path: &Path, is_wanted: impl Fn(&str) -> bool) -> Result<Document> {
    let mut document = Document::read(path)?;
    match complete(path, &mut document.tree, is_wanted) {
        Ok(()) => Ok(document),
        Err(reason) => Err(Scope::of(&document)
            .key("arrays")
            .wrong(reason.to_string(), "the file that was written with it")),
    }
}

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
fn of_solution(path: &Path, system: &System) -> Result<Voltages> {
    let document =
        &solution_document(path, |name| name == "time" || name.starts_with("voltages/"))?;
    let solution: SolutionRecord = document.parse()?;
    let at = At::new(&Scope::of(document), system);
    let instants: Vec<f64> = solution.time.iter().map(|time| 1e3 * time).collect();
    let all_series = solution.voltages.iter();
    let all_series = all_series.map(|(name, series)| (name, series.iter().copied()));
    let rows = rows(&instants, all_series, &at)?;
    let hold = match &solution.hold {
        Some(hold) => {
            let mut row = vec![0.0; at.sources.len()];
            for (name, &voltage) in hold {
                row[at.key("hold").key(name).driven(name)?] = voltage;
            }
            Some(row)
        }
        None => None,
    };
    Ok(sampled(instants, rows, hold, Some(path.to_owned())))
}

/// Voltages of a table, then those that it says are held, or the last ones; 0 for sources that it does not name.
fn of_table(table: &TableSpec, at: &At<'_>) -> Result<Voltages> {
    let instants: Vec<f64> = table.time.iter().map(|time| time.value()).collect();
    let all_series = table.voltages.iter();
    let all_series = all_series.map(|(name, series)| (name, series.iter().map(Quantity::value)));
    let rows = rows(&instants, all_series, at)?;
    refuse!(if instants[0] != 0.0, at.key("time").index(0);
        found format!("{} s", instants[0] / 1e3), expected "0");
    let hold = match &table.hold {
        Some(hold) => Some(at.key("hold").voltages(hold)?),
        None => None,
    };
    Ok(sampled(instants, rows, hold, None))
}

/// A row of voltages for each interval between instants in ms, and one of zeros for what follows.
fn rows<'a>(
    instants: &[f64],
    all_series: impl Iterator<Item = (&'a String, impl ExactSizeIterator<Item = f64>)>,
    at: &At<'_>,
) -> Result<Vec<Vec<f64>>> {
    let place = at.key("time");
    refuse!(if instants.len() < 2, place;
        found format!("{} instants", instants.len()), expected "2 instants or more");
    place.increasing(instants)?;
    let intervals = instants.len() - 1;
    let mut rows = vec![vec![0.0; at.sources.len()]; intervals + 1];
    for (name, series) in all_series {
        let place = at.key("voltages").key(name);
        let source = place.driven(name)?;
        refuse!(if series.len() != intervals, place;
            found format!("{} voltages", series.len()),
            expected format!("{intervals}, one per interval"));
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
