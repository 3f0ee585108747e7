//! `solution.json`: a motion in files' units with all that a later run needs to start from it exactly.
//!
//! People read `time` (s), `configuration` (m, rad), `voltages` and, where a goal has any, the voltages that `hold` it (V);
//! `state` holds coordinates and multipliers of the
//! instants as the program has them (g, mm, ms, N), in reduced coordinates then a quaternion (w, x, y, z) for each spherical or floating joint,
//! behind which its three turns count, and `costates` the multipliers of the optimisation, unscaled. A file made
//! by hand needs `time`, `voltages` and the coordinates of the joints, in `joints` or in `configuration.joints`.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::error::Error;
use std::io;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use crate::control::{Costates, EarlierSolution, Solution};
use crate::files::lay_out;
use crate::kinematics::Pose;
use crate::math::Matrix;
use crate::model::system::{Joint, JointKind, Source, System};
use crate::model::{Coordinates, FoundParameter, Model};

/// ms in a s.
const SECOND: f64 = 1e3;
/// mm in a m.
const METRE: f64 = 1e3;

/// An earlier solution cannot be used.
#[derive(Debug, thiserror::Error)]
#[error("{}: {reason}", path.display())]
pub struct SolutionError {
    /// The file.
    pub path: PathBuf,
    /// Why.
    pub reason: Reason,
}

/// Why a file is no solution of a scene.
#[derive(Debug, thiserror::Error)]
pub enum Reason {
    /// It cannot be read.
    #[error("cannot be read: {0}")]
    Unreadable(io::Error),
    /// It is not JSON.
    #[error("no JSON: {0}")]
    NoJson(serde_json::Error),
    /// It is JSON, but no solution.
    #[error(
        "{place}: {found}; a solution.json holds \"time\", \"voltages\", and joint coordinates in \"configuration\" or \"joints\""
    )]
    NoSolution {
        /// Path in the file.
        place: String,
        /// What is wrong there.
        found: String,
    },
    /// Its names are not those of the scene.
    #[error("belongs to another scene: {0}")]
    OtherScene(String),
    /// Its parts do not fit together.
    #[error("{0}")]
    Contradiction(String),
}

/// The file.
#[derive(Debug, Default, Serialize, Deserialize)]
struct File {
    #[serde(default)]
    scene: String,
    time: Vec<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    joints: Option<BTreeMap<String, Vec<f64>>>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    configuration: Option<ConfigurationRecord>,
    voltages: BTreeMap<String, Vec<f64>>,
    /// Voltages that hold the goal.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    hold: Option<BTreeMap<String, f64>>,
    /// Potentials of elastic blocks by interval, as multiples of their unit.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    potentials: Vec<Vec<f64>>,
    /// Sought parameters by their names, in SI units.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    parameters: BTreeMap<String, f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    coordinates: Option<String>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    state: Option<StateRecord>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    costates: Option<Multipliers>,
}

#[derive(Debug, Serialize, Deserialize)]
struct ConfigurationRecord {
    #[serde(default)]
    bodies: BTreeMap<String, Body>,
    joints: BTreeMap<String, Vec<f64>>,
}

/// Centre (m) and directors d₁, d₂, d₃ of a body at each instant.
#[derive(Debug, Serialize, Deserialize)]
struct Body {
    centre: Vec<[f64; 3]>,
    directors: Vec<[[f64; 3]; 3]>,
}

/// Times in ms, coordinates and multipliers by instant, and reference places of the nodes of each mesh.
#[derive(Debug, Serialize, Deserialize)]
struct StateRecord {
    times_ms: Vec<f64>,
    multiplier_time_ms: f64,
    z: Vec<Vec<f64>>,
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    meshes_mm: BTreeMap<String, Vec<[f64; 3]>>,
}

#[derive(Debug, Serialize, Deserialize)]
struct Multipliers {
    rows: Vec<f64>,
    lower: Vec<f64>,
    upper: Vec<f64>,
}

/// The text of `solution.json`.
pub fn text(model: &Model, solved: &Solution) -> String {
    let system = &model.system;
    let columns = |j: usize, unit: f64| solved.joints.iter().map(|row| row[j] / unit).collect();
    let joints = system.joints.iter().enumerate();
    let joints = joints
        .filter(|(_, joint)| joint.has_coordinate())
        .map(|(j, joint)| (joint.name.clone(), columns(j, unit(joint))));
    let body = |b: usize| Body {
        centre: solved
            .poses
            .iter()
            .map(|p| (p[b].centre / METRE).into())
            .collect(),
        directors: solved.poses.iter().map(|p| p[b].directors.into()).collect(),
    };
    let bodies = system.bodies.iter().enumerate();
    let sources = system.sources();
    let voltage = |&s: &usize| {
        let history = solved.voltages.iter().map(|row| row[s]).collect();
        (sources[s].name.clone(), history)
    };
    let file = File {
        scene: system.name.clone(),
        time: solved.times.iter().map(|t| t / SECOND).collect(),
        joints: None,
        configuration: Some(ConfigurationRecord {
            bodies: bodies.map(|(b, it)| (it.name.clone(), body(b))).collect(),
            joints: joints.collect(),
        }),
        voltages: model.reached.iter().map(voltage).collect(),
        hold: solved.hold.as_ref().map(|row| {
            let held = |&s: &usize| (sources[s].name.clone(), row[s]);
            model.reached.iter().map(held).collect()
        }),
        potentials: solved.potentials.clone(),
        parameters: solved
            .parameters
            .iter()
            .map(|found| (found.name.clone(), found.value * found.unit.factor))
            .collect(),
        coordinates: Some(solved.coordinates.name().to_owned()),
        state: Some(StateRecord {
            times_ms: solved.times.clone(),
            multiplier_time_ms: solved.multiplier_time,
            z: solved.z.clone(),
            meshes_mm: solved.meshes.clone(),
        }),
        costates: solved.costates.clone().map(|c| Multipliers {
            rows: c.rows,
            lower: c.lower,
            upper: c.upper,
        }),
    };
    let text = serde_json::to_string(&file).expect("numbers and names are JSON");
    lay_out(&text)
}

/// A `solution.json`, read once the model exists.
#[derive(Clone, Debug)]
pub struct SolutionFile(pub PathBuf);

impl EarlierSolution for SolutionFile {
    fn solution(&self, model: &Model) -> Result<Cow<'_, Solution>, Box<dyn Error + Send + Sync>> {
        Ok(Cow::Owned(read(&self.0, model)?))
    }
}

/// Reads a `solution.json` of the scene of a model.
///
/// # Errors
/// The file is no solution, or one of another scene.
pub fn read(path: &Path, model: &Model) -> Result<Solution, SolutionError> {
    parse(path, model).map_err(|reason| SolutionError {
        path: path.to_owned(),
        reason,
    })
}

fn parse(path: &Path, model: &Model) -> Result<Solution, Reason> {
    let text = std::fs::read_to_string(path).map_err(Reason::Unreadable)?;
    let value: serde_json::Value = serde_json::from_str(&text).map_err(Reason::NoJson)?;
    let file: File =
        serde_path_to_error::deserialize(&value).map_err(|error| Reason::NoSolution {
            place: error.path().to_string(),
            found: error.inner().to_string(),
        })?;
    let instants = file.time.len();
    if instants < 2 || file.time.windows(2).any(|pair| pair[0] >= pair[1]) {
        let reason = "\"time\" needs two instants or more, in increasing order";
        return Err(Reason::Contradiction(reason.to_owned()));
    }
    let system = &model.system;
    let by_joint = match (&file.configuration, &file.joints) {
        (Some(configuration), _) => &configuration.joints,
        (None, Some(joints)) => joints,
        (None, None) => {
            return Err(Reason::NoSolution {
                place: "configuration".to_owned(),
                found: "missing".to_owned(),
            });
        }
    };
    let named = |joint: &&Joint| joint.has_coordinate();
    let joints = system.joints.iter().filter(named).map(|j| j.name.as_str());
    same_names("joint", by_joint.keys().map(String::as_str), joints)?;
    let sources = system.sources();
    let driven = model.reached.iter().map(|&s| sources[s].name.as_str());
    let named = file.voltages.keys().map(String::as_str);
    same_names("muscle or electrode", named, driven)?;
    let place_of = |name: &str, system: &System| {
        let found = system.joints.iter().position(|joint| joint.name == name);
        found.expect("the names were compared")
    };
    let mut joint_rows = vec![vec![0.0; system.joints.len()]; instants];
    for (name, column) in by_joint {
        same_length(name, column.len(), instants, "instants")?;
        let j = place_of(name, system);
        for (row, value) in joint_rows.iter_mut().zip(column) {
            row[j] = value * unit(&system.joints[j]);
        }
    }
    let mut voltages = vec![vec![0.0; sources.len()]; instants - 1];
    for &s in &model.reached {
        let name = &sources[s].name;
        let column = &file.voltages[name];
        same_length(name, column.len(), instants - 1, "intervals")?;
        for (row, &value) in voltages.iter_mut().zip(column) {
            row[s] = value;
        }
    }
    let hold = match &file.hold {
        None => None,
        Some(held) => {
            let driven = model.reached.iter().map(|&s| sources[s].name.as_str());
            let named = held.keys().map(String::as_str);
            same_names("muscle or electrode", named, driven)?;
            let value = |source: &Source| held.get(&source.name).copied().unwrap_or(0.0);
            Some(sources.iter().map(value).collect())
        }
    };
    let poses = poses(file.configuration.as_ref(), system, instants)?;
    let coordinates = match file.coordinates.as_deref() {
        Some("reduced") => Coordinates::Reduced,
        Some("redundant") => Coordinates::Redundant,
        None => model.coordinates,
        Some(other) => {
            return Err(Reason::NoSolution {
                place: "coordinates".to_owned(),
                found: format!("{other:?}, expected \"reduced\" or \"redundant\""),
            });
        }
    };
    let meshes = file.state.as_ref().map(|state| state.meshes_mm.clone());
    let (times, multiplier_time, z) = match file.state {
        Some(state) => {
            same_length("state.times_ms", state.times_ms.len(), instants, "instants")?;
            same_length("state.z", state.z.len(), instants, "instants")?;
            let motion = &model.action.motion;
            let is_wrong = |z: &Vec<f64>| !motion.has_unit_charts(z);
            if let (true, Some(k)) = (
                coordinates == model.coordinates,
                state.z.iter().position(is_wrong),
            ) {
                return Err(Reason::NoSolution {
                    place: format!("state.z[{k}]"),
                    found: "a rotation whose quaternion does not have length one".to_owned(),
                });
            }
            (state.times_ms, state.multiplier_time_ms, state.z)
        }
        None => {
            let times = file.time.iter().map(|t| t * SECOND).collect();
            let z = joint_rows.iter().map(|row| model.coordinates_at(row));
            (times, model.multiplier_time, z.collect())
        }
    };
    Ok(Solution {
        coordinates,
        times,
        joints: joint_rows,
        poses,
        z,
        meshes: meshes.unwrap_or_default(),
        multiplier_time,
        voltages,
        hold,
        potentials: file.potentials,
        parameters: sought(&file.parameters, model),
        costates: file.costates.map(|c| Costates {
            rows: c.rows,
            lower: c.lower,
            upper: c.upper,
        }),
    })
}

/// Values of those parameters of a file that a model seeks.
fn sought(file: &BTreeMap<String, f64>, model: &Model) -> Vec<FoundParameter> {
    let parameters = model.analysis.parameters.iter();
    let found = parameters.filter_map(|parameter| {
        let unit = parameter.unit(&model.system);
        let value = file.get(&parameter.name)? / unit.factor;
        Some(parameter.found(value, &model.system))
    });
    found.collect()
}

/// Poses by instant and body; none where the file gives none.
fn poses(
    configuration: Option<&ConfigurationRecord>,
    system: &System,
    instants: usize,
) -> Result<Vec<Vec<Pose>>, Reason> {
    let Some(configuration) = configuration.filter(|c| !c.bodies.is_empty()) else {
        return Ok(Vec::new());
    };
    let names = system.bodies.iter().map(|body| body.name.as_str());
    same_names(
        "body",
        configuration.bodies.keys().map(String::as_str),
        names,
    )?;
    let mut poses = vec![vec![Pose::GROUND; system.bodies.len()]; instants];
    for (b, body) in system.bodies.iter().enumerate() {
        let Body { centre, directors } = &configuration.bodies[&body.name];
        same_length(&body.name, centre.len(), instants, "instants")?;
        same_length(&body.name, directors.len(), instants, "instants")?;
        for (row, (centre, directors)) in poses.iter_mut().zip(centre.iter().zip(directors)) {
            row[b] = Pose {
                centre: crate::math::Vector::from(*centre) * METRE,
                directors: Matrix::from(*directors),
            };
        }
    }
    Ok(poses)
}

/// Length of a unit of the file in the units inside: rad for angles, m for displacements.
fn unit(joint: &Joint) -> f64 {
    match joint.kind {
        JointKind::Prismatic { .. } => METRE,
        _ => 1.0,
    }
}

fn same_names<'a>(
    what: &str,
    file: impl Iterator<Item = &'a str>,
    scene: impl Iterator<Item = &'a str>,
) -> Result<(), Reason> {
    let (file, scene): (Vec<_>, Vec<_>) = (file.collect(), scene.collect());
    let unknown = file.iter().find(|name| !scene.contains(name));
    let missing = scene.iter().find(|name| !file.contains(name));
    match (unknown, missing) {
        (None, None) => Ok(()),
        (Some(name), _) => Err(Reason::OtherScene(format!(
            "this one has no {what} {name:?}"
        ))),
        (None, Some(name)) => Err(Reason::OtherScene(format!(
            "the {what} {name:?} of this one is missing there"
        ))),
    }
}

fn same_length(name: &str, found: usize, expected: usize, of: &str) -> Result<(), Reason> {
    if found == expected {
        return Ok(());
    }
    Err(Reason::Contradiction(format!(
        "{name} has {found} values for {expected} {of}"
    )))
}
