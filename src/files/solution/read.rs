//! Reader of solution files: from a file to a solution of a model.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::error::Error;
use std::io;
use std::path::{Path, PathBuf};

use crate::control::{Costates, EarlierSolution, Solution};
use crate::files::json::reader::Reader;
use crate::files::json::scan::Scanner;
use crate::files::json::source::{NoBytes, check_json, of_file};
use crate::files::solution::arrays::complete;
use crate::files::solution::error::{Reason, SolutionError};
use crate::files::solution::record::{Body, ConfigurationRecord, File, METRE, SECOND, unit};
use crate::kinematics::Pose;
use crate::math::Matrix;
use crate::model::system::{Joint, Source, System};
use crate::model::{Coordinates, FoundParameter, Model};

/// A `solution.json`, read once the model exists.
#[derive(Clone, Debug)]
pub struct SolutionFile(pub PathBuf);

impl EarlierSolution for SolutionFile {
    fn solution(&self, model: &Model) -> Result<Cow<'_, Solution>, Box<dyn Error + Send + Sync>> {
        Ok(Cow::Owned(read(&self.0, model)?))
    }

    fn file(&self) -> Option<&Path> {
        Some(&self.0)
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

/// The file as it is written, with the arrays that stand in another one.
fn read_file(path: &Path) -> Result<File, Reason> {
    let bytes = of_file(path).map_err(|error| match error {
        NoBytes::Unreadable(cause) => Reason::Unreadable(cause),
        NoBytes::TooLarge(found, expected) => Reason::TooLarge { found, expected },
    })?;
    let utf8 = |error| io::Error::new(io::ErrorKind::InvalidData, error);
    let text = String::from_utf8(bytes).map_err(|error| Reason::Unreadable(utf8(error)))?;
    check_json(&text).map_err(Reason::NoJson)?;
    let read = match Scanner::of(&text).entry("arrays") {
        None => serde_path_to_error::deserialize(&mut Reader::of(&text)),
        Some(_) => {
            let mut values = serde_json::from_str(&text).map_err(Reason::NoJson)?;
            complete(path, &mut values, |_| true)?;
            serde_path_to_error::deserialize(&values)
        }
    };
    read.map_err(|error| Reason::NoSolution {
        place: error.path().to_string(),
        found: error.inner().to_string(),
    })
}

fn parse(path: &Path, model: &Model) -> Result<Solution, Reason> {
    let file = read_file(path)?;
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
    let by_source = file.voltages.ok_or_else(|| Reason::NoSolution {
        place: ".".to_owned(),
        found: "missing field `voltages`".to_owned(),
    })?;
    let named = by_source.keys().map(String::as_str);
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
        let column = &by_source[name];
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
        None => model.coordinates,
        Some(word) => Coordinates::named(word).ok_or_else(|| Reason::NoSolution {
            place: "coordinates".to_owned(),
            found: format!("{word:?}, expected \"reduced\" or \"redundant\""),
        })?,
    };
    let meshes = file.state.as_ref().map(|state| state.meshes_mm.clone());
    let (times, multiplier_time, z, momentum) = match file.state {
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
            (
                state.times_ms,
                state.multiplier_time_ms,
                state.z,
                state.momentum,
            )
        }
        None => {
            let times = file.time.iter().map(|t| t * SECOND).collect();
            let z = joint_rows.iter().map(|row| model.coordinates_at(row));
            (times, model.multiplier_time, z.collect(), Vec::new())
        }
    };
    Ok(Solution {
        coordinates,
        times,
        joints: joint_rows,
        poses,
        z,
        momentum,
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
        barrier: file.barrier.filter(|mu| mu.is_finite() && *mu > 0.0),
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
