//! Joint coordinates over time, from an earlier `solution.json`.

use serde::Deserialize;
use std::collections::BTreeMap;
use std::path::Path;

use crate::files::json::error::SceneError;
use crate::files::json::scope::Scope;
use crate::files::problem::solution_document::solution_document;
use crate::files::problem::state::joint_with_coordinate;
use crate::math::Signal;
use crate::model::joint_unit;
use crate::model::system::System;

/// Entries that are read of a solution: coordinates in rad or m by joint, one per instant.
#[derive(Debug, Deserialize)]
struct SolutionRecord {
    /// Instants in s.
    time: Vec<f64>,
    #[serde(default)]
    joints: Option<Coordinates>,
    #[serde(default)]
    configuration: Option<Configuration>,
}

type Coordinates = BTreeMap<String, Vec<f64>>;

#[derive(Debug, Deserialize)]
struct Configuration {
    joints: Coordinates,
}

/// The coordinate of each joint of a solution by index, linear between its instants.
pub(crate) fn read(path: &Path, system: &System) -> Result<Vec<(usize, Signal)>, SceneError> {
    let document = &solution_document(path, |name| {
        name == "time" || name.starts_with("configuration/joints/")
    })?;
    let solution: SolutionRecord = document.parse()?;
    let scope = Scope::of(document);
    let place = scope.key("time");
    let times: Vec<f64> = solution.time.iter().map(|time| 1e3 * time).collect();
    if times.is_empty() {
        return Err(place.wrong("no instant", "one or more"));
    }
    place.increasing(&times)?;
    let (joints, place) = match (solution.configuration, solution.joints) {
        (Some(configuration), _) => (
            configuration.joints,
            scope.key("configuration").key("joints"),
        ),
        (None, Some(joints)) => (joints, scope.key("joints")),
        (None, None) => {
            return Err(scope.wrong("neither of them", "\"configuration\" or \"joints\""));
        }
    };
    let signal = |(name, values): (String, Vec<f64>)| {
        let place = place.key(&name);
        let joint = joint_with_coordinate(&name, system, &place)?;
        if values.len() != times.len() {
            let found = format!("{} values", values.len());
            let expected = format!("{}, one for each instant", times.len());
            return Err(place.wrong(found, expected));
        }
        let unit = match joint_unit(system, joint) {
            "mm" => 1e3,
            _ => 1.0,
        };
        let values = values.into_iter().map(|value| unit * value).collect();
        let times = times.clone();
        Ok((joint, Signal::Table { times, values }))
    };
    joints.into_iter().map(signal).collect()
}
