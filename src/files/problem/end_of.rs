//! The end of another result, from which a motion starts.

use serde::Deserialize;
use serde::de::IgnoredAny;
use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

use crate::control::EndState;
use crate::dynamics::StepState;
use crate::files::continuation;
use crate::files::json::scope::{Result, Scope, list, refuse};
use crate::files::problem::at::At;
use crate::files::solution::{Body, ConfigurationRecord, record};
use crate::kinematics::Pose;
use crate::math::{Matrix, Vector};
use crate::model::Coordinates;

/// Expected value of a path.
const FOLDER: &str = "the folder of a simulation or of a solved control problem, which holds a solution.json; a state of rest is \"rest_at_voltages\"";
/// Program that writes the expected file.
const WRITTEN: &str = "a result that simulate or solve wrote";
/// Status of solves whose solution is a motion of the robot.
const SOLVED: [&str; 4] = ["solved", "acceptable", "feasible_point", "not_held"];
/// Status of a simulation that came to its end; others go as far as they go.
const SIMULATED: &str = "simulated";

/// Entries that are read of a summary.
#[derive(Deserialize)]
struct Summary {
    status: String,
    /// Of a simulation.
    #[serde(default)]
    steps: Option<IgnoredAny>,
}

/// The last instant of the result that a path names.
pub(crate) fn end_of(path: &str, at: &At<'_>) -> Result<EndState> {
    let file = at.solution_file(path, FOLDER)?;
    let notes = status(&file, at)?;
    let (document, ended) = record(&file, |name| !name.starts_with("costates/"))?;
    let configuration = ended.configuration;
    let configuration =
        configuration.ok_or_else(|| Scope::of(&document).missing_key("configuration"))?;
    let (voltages, loads) = (
        ended.voltages.unwrap_or_default(),
        ended.loads.unwrap_or_default(),
    );
    check_names(&configuration, voltages.keys(), path, at)?;
    let untold = |what: &str| at.wrong(format!("{path:?}, which does not tell {what}"), WRITTEN);
    let coordinates = ended.coordinates.as_deref().and_then(Coordinates::named);
    let coordinates = coordinates.ok_or_else(|| untold("in which \"coordinates\" it is"))?;
    let mut state = ended
        .state
        .ok_or_else(|| untold("the \"state\" of its motion"))?;
    let z = state.z.pop().ok_or_else(|| untold("\"state.z\""))?;
    if state.momentum.is_empty() != z.is_empty() {
        return Err(untold("the \"state.momentum\" at its end"));
    }
    let mut poses = Vec::new();
    for body in &at.system.bodies {
        let Body { centre, directors } = &configuration.bodies[&body.name];
        let (Some(centre), Some(directors)) = (centre.last(), directors.last()) else {
            return Err(untold(&format!("where body {:?} ended", body.name)));
        };
        poses.push(Pose {
            centre: Vector::from(*centre) * 1e3,
            directors: Matrix::from(*directors),
        });
    }
    let mut inputs = Vec::new();
    for source in at.sources.iter() {
        let held = ended.hold.as_ref().and_then(|hold| hold.get(&source.name));
        let all = if source.is_load() { &loads } else { &voltages };
        let last = all.get(&source.name).and_then(|list| list.last());
        let (_, unit) = source.kind.si();
        inputs.push(held.or(last).copied().unwrap_or(0.0) * unit);
    }
    Ok(EndState {
        source: file.parent().unwrap_or(&file).to_owned(),
        coordinates,
        method: method(&file, &z, &state.momentum, at)?,
        z,
        momentum: state.momentum,
        poses,
        meshes: state.meshes_mm,
        voltages: inputs,
        notes,
    })
}

/// Refuses a result that is no motion, and returns notes on one that is.
fn status(file: &Path, at: &Scope<'_>) -> Result<Vec<String>> {
    let beside = file.with_file_name("summary.json");
    let shown = file.display();
    let text = fs::read_to_string(&beside).ok();
    let summary = text.and_then(|text| serde_json::from_str::<Summary>(&text).ok());
    let Some(Summary { status, steps }) = summary else {
        return Ok(vec![format!(
            "no summary.json beside {shown} tells whether it is a motion of the robot"
        )]);
    };
    match (steps.is_some(), status.as_str()) {
        (true, SIMULATED) => Ok(Vec::new()),
        (true, _) => Ok(vec![format!(
            "{shown} ended early ({status}); the motion starts where it ended"
        )]),
        (false, word) if SOLVED.contains(&word) => Ok(Vec::new()),
        (false, _) => {
            let found = format!("{shown}, whose status is {status:?}");
            Err(at.wrong(
                found,
                format!(
                    "a motion of the robot: a simulation, or one of {}",
                    list(SOLVED.iter())
                ),
            ))
        }
    }
}

/// Refuses a result of other bodies, joints or sources.
fn check_names<'v>(
    configuration: &ConfigurationRecord,
    mut voltages: impl Iterator<Item = &'v String>,
    path: &str,
    at: &At<'_>,
) -> Result<()> {
    let ConfigurationRecord { bodies, joints } = configuration;
    let own_bodies: BTreeSet<_> = at.system.bodies.iter().map(|body| &body.name).collect();
    let own_joints = at.system.joints.iter().filter(|one| one.has_coordinate());
    let own_joints = own_joints.map(|joint| &joint.name).collect();
    for (kind, there, here) in [
        ("body", bodies.keys().collect::<BTreeSet<_>>(), own_bodies),
        ("joint", joints.keys().collect(), own_joints),
    ] {
        refuse!(if let Some(name) = here.difference(&there).next(), at;
            found format!("{path:?}, which has no {kind} {name:?}"),
            expected "a result of the same robot");
        refuse!(if let Some(name) = there.difference(&here).next(), at;
            found format!("{path:?}, whose {kind} {name:?} is not in the scene"),
            expected "a result of the same robot");
    }
    let unknown = voltages.find(|name| !at.sources.iter().any(|source| source.name == **name));
    refuse!(if let Some(name) = unknown, at;
        found format!("{path:?}, whose muscle or electrode {name:?} is not in the scene"),
        expected "a result of the same robot");
    Ok(())
}

/// The state of the method of a simulation; of a solve none is kept.
fn method(file: &Path, z: &[f64], momentum: &[f64], at: &Scope<'_>) -> Result<StepState> {
    let beside = file.with_file_name("continuation.npz");
    if !beside.is_file() {
        return Ok(StepState::default());
    }
    let shown = beside.display();
    let read = continuation::read(&beside);
    let read = read.map_err(|error| at.wrong(format!("{shown}: {error}"), WRITTEN))?;
    let discrete = read.discrete;
    let ends = [&discrete.z, &discrete.momenta].map(|rows| rows.last().map(Vec::as_slice));
    refuse!(if ends != [Some(z), Some(momentum)], at;
        found format!("{shown}, which is not of the motion in {}", file.display()),
        expected "files of one run");
    Ok(discrete.end.begun_anew())
}
