//! Voltages over time from an earlier `solution.json`.

use serde::Deserialize;
use std::collections::BTreeMap;
use std::path::Path;

use crate::control::problem::{Afterwards, Voltages};
use crate::model::system::System;
use crate::scene::build_state::driven;
use crate::scene::document::Document;
use crate::scene::error::SceneError;
use crate::scene::scope::Scope;

/// What is read of a solution.
#[derive(Debug, Deserialize)]
struct Solution {
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
pub(crate) fn sampled_voltages(path: &Path, system: &System) -> Result<Voltages, SceneError> {
    let document = &Document::read(path)?;
    let solution: Solution = document.parse()?;
    let scope = Scope::of(document);
    let place = scope.key("time");
    if solution.time.len() < 2 {
        let found = format!("{} instants", solution.time.len());
        return Err(place.wrong(found, "2 instants or more"));
    }
    if let Some(index) = solution.time.windows(2).position(|pair| pair[0] >= pair[1]) {
        let found = solution.time[index + 1].to_string();
        return Err(place.index(index + 1).wrong(found, "increasing times"));
    }
    let ends: Vec<f64> = solution.time[1..].iter().map(|time| 1e3 * time).collect();
    let sources = system.sources();
    let mut rows = vec![vec![0.0; sources.len()]; ends.len()];
    for (name, history) in &solution.voltages {
        let place = scope.key("voltages").key(name);
        let source = driven(name, &sources, &place)?;
        if history.len() != ends.len() {
            let found = format!("{} voltages", history.len());
            let expected = format!("{}, one per interval", ends.len());
            return Err(place.wrong(found, expected));
        }
        for (row, voltage) in rows.iter_mut().zip(history) {
            row[source] = *voltage;
        }
    }
    let (last, afterwards) = match &solution.hold {
        Some(hold) => {
            let mut row = vec![0.0; sources.len()];
            for (name, &voltage) in hold {
                row[driven(name, &sources, &scope.key("hold").key(name))?] = voltage;
            }
            (row, Afterwards::OfGoal)
        }
        None => (rows[ends.len() - 1].clone(), Afterwards::OfLastInterval),
    };
    rows.push(last);
    Ok(Voltages::Sampled {
        ends,
        rows,
        afterwards,
        solution: path.to_owned(),
    })
}
