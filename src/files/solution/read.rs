//! Reader of solution files: from a file to a solution of a model.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::error::Error;
use std::io;
use std::path::{Path, PathBuf};

use crate::control::{Costates, EarlierSolution, Solution};
use crate::files::json::document::{Document, NoBytes, check_json, of_file, unmarked};
use crate::files::json::error::SceneError;
use crate::files::json::scope::Scope;
use crate::files::json::tree::Tree;
use crate::files::solution::arrays::complete;
use crate::files::solution::record::{
    Body, ConfigurationRecord, METRE, Reason, Result, SECOND, SolutionError, SolutionRecord,
    StateRecord, unit,
};
use crate::kinematics::Pose;
use crate::math::Matrix;
use crate::model::system::{Joint, Source, System};
use crate::model::{Coordinates, FoundParameter, Model};

/// Values over time by name.
type Columns = BTreeMap<String, Vec<f64>>;

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

/// The file as a document for messages, and what it says, with those arrays that are wanted.
pub(crate) fn record(
    path: &Path,
    is_wanted: impl Fn(&str) -> bool,
) -> Result<(Document, SolutionRecord), SceneError> {
    let mut document = Document::read(path)?;
    if let Err(reason) = complete(path, &mut document.tree, is_wanted) {
        let place = Scope::of(&document).key("arrays");
        return Err(place.wrong(reason.to_string(), "the file that was written with it"));
    }
    let record = document.parse()?;
    Ok((document, record))
}

/// The file as it is written, with the arrays that stand in another one.
fn read_file(path: &Path) -> Result<SolutionRecord> {
    let bytes = of_file(path).map_err(|error| match error {
        NoBytes::Unreadable(cause) => Reason::Unreadable(cause),
        NoBytes::TooLarge(found, expected) => Reason::TooLarge { found, expected },
    })?;
    let utf8 = |error| io::Error::new(io::ErrorKind::InvalidData, error);
    let text = String::from_utf8(bytes).map_err(|error| Reason::Unreadable(utf8(error)))?;
    let mut solution = Tree::of(unmarked(text));
    check_json(solution.text()).map_err(Reason::NoJson)?;
    complete(path, &mut solution, |_| true)?;
    solution.json().read().map_err(|misfit| Reason::NoSolution {
        place: misfit.place().to_string(),
        found: misfit.to_string(),
    })
}

/// Reads the file and checks it against the scene of the model.
fn parse(path: &Path, model: &Model) -> Result<Solution> {
    let file = read_file(path)?;
    check_times(&file.time)?;
    let (system, instants) = (&model.system, file.time.len());
    let by_joint = joint_columns(&file, system)?;
    let by_source = file.voltages.as_ref().ok_or_else(|| Reason::NoSolution {
        place: ".".to_owned(),
        found: "missing field `voltages`".to_owned(),
    })?;
    same_inputs(0, by_source, model)?;
    let loads = file.loads.clone().unwrap_or_default();
    same_inputs(1, &loads, model)?;
    let joints = joint_rows(by_joint, system, instants)?;
    let voltages = input_rows([by_source, &loads], model, instants - 1)?;
    let loads = file.hold_loads.as_ref();
    let held = file.hold.as_ref();
    let hold = held.map(|held| hold(held, loads, voltages.last(), model));
    let hold = hold.transpose()?;
    let poses = poses(file.configuration.as_ref(), system, instants)?;
    let coordinates = coordinates(file.coordinates.as_deref(), model)?;
    let state = match file.state {
        Some(state) => checked_state(state, coordinates, model, instants)?,
        None => state_of_joints(&file.time, &joints, model),
    };
    Ok(Solution {
        coordinates,
        times: state.times_ms,
        joints,
        poses,
        z: state.z,
        momentum: state.momentum,
        meshes: state.meshes_mm,
        multiplier_time: state.multiplier_time_ms,
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

fn check_times(times: &[f64]) -> Result<()> {
    if times.len() < 2 || times.windows(2).any(|pair| pair[0] >= pair[1]) {
        let reason = "\"time\" needs two instants or more, in increasing order";
        return Err(Reason::Contradiction(reason.to_owned()));
    }
    Ok(())
}

/// Coordinates by joint, one column for each joint of the scene that has a coordinate.
fn joint_columns<'f>(file: &'f SolutionRecord, system: &System) -> Result<&'f Columns> {
    let columns = match (&file.configuration, &file.joints) {
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
    same_names("joint", columns.keys(), joints)?;
    Ok(columns)
}

/// Coordinates by instant and joint, in the units inside.
fn joint_rows(columns: &Columns, system: &System, instants: usize) -> Result<Vec<Vec<f64>>> {
    let mut rows = vec![vec![0.0; system.joints.len()]; instants];
    for (name, column) in columns {
        same_length(name, column.len(), instants, "instants")?;
        let found = system.joints.iter().position(|joint| joint.name == *name);
        let j = found.expect("the names were compared");
        for (row, value) in rows.iter_mut().zip(column) {
            row[j] = value * unit(&system.joints[j]);
        }
    }
    Ok(rows)
}

/// Voltages and loads by interval and source.
fn input_rows(
    [voltages, loads]: [&Columns; 2],
    model: &Model,
    intervals: usize,
) -> Result<Vec<Vec<f64>>> {
    let sources = &model.sources;
    let mut rows = vec![vec![0.0; sources.len()]; intervals];
    for &s in &model.reached {
        let Source { name, kind, .. } = &sources[s];
        let columns = if sources[s].is_load() {
            loads
        } else {
            voltages
        };
        let column = &columns[name];
        same_length(name, column.len(), intervals, "intervals")?;
        for (row, &value) in rows.iter_mut().zip(column) {
            row[s] = value * kind.si().1;
        }
    }
    Ok(rows)
}

/// Inputs by source that hold the goal: these voltages, and these loads or those of the last interval.
fn hold(
    held: &BTreeMap<String, f64>,
    loads: Option<&BTreeMap<String, f64>>,
    last: Option<&Vec<f64>>,
    model: &Model,
) -> Result<Vec<f64>> {
    same_inputs(0, held, model)?;
    if let Some(loads) = loads {
        same_inputs(1, loads, model)?;
    }
    let value = |(s, source): (usize, &Source)| {
        let load = || {
            loads?
                .get(&source.name)
                .map(|load| load * source.kind.si().1)
        };
        match source.is_load() {
            true => load().or_else(|| Some(last?[s])),
            false => held.get(&source.name).copied(),
        }
        .unwrap_or(0.0)
    };
    Ok(model.sources.iter().enumerate().map(value).collect())
}

/// Coordinates that a file names, or those of the model.
fn coordinates(word: Option<&str>, model: &Model) -> Result<Coordinates> {
    match word {
        None => Ok(model.coordinates),
        Some(word) => Coordinates::named(word).ok_or_else(|| Reason::NoSolution {
            place: "coordinates".to_owned(),
            found: format!("{word:?}, expected \"reduced\" or \"redundant\""),
        }),
    }
}

/// A state of the file, with a value for each instant, and rotations where its coordinates are those of the model.
fn checked_state(
    state: StateRecord,
    coordinates: Coordinates,
    model: &Model,
    instants: usize,
) -> Result<StateRecord> {
    same_length("state.times_ms", state.times_ms.len(), instants, "instants")?;
    same_length("state.z", state.z.len(), instants, "instants")?;
    let map = &model.action.map;
    let is_wrong = |z: &Vec<f64>| !map.has_unit_charts(z);
    let wrong = state.z.iter().position(is_wrong);
    match wrong.filter(|_| coordinates == model.coordinates) {
        Some(k) => Err(Reason::NoSolution {
            place: format!("state.z[{k}]"),
            found: "a rotation whose quaternion does not have length one".to_owned(),
        }),
        None => Ok(state),
    }
}

/// State at given joint coordinates, of a file that has none.
fn state_of_joints(times: &[f64], joints: &[Vec<f64>], model: &Model) -> StateRecord {
    let z = joints.iter().map(|row| model.coordinates_at(row));
    StateRecord {
        times_ms: times.iter().map(|t| t * SECOND).collect(),
        multiplier_time_ms: model.multiplier_time,
        z: z.collect(),
        momentum: Vec::new(),
        meshes_mm: BTreeMap::new(),
    }
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
) -> Result<Vec<Vec<Pose>>> {
    let Some(configuration) = configuration.filter(|c| !c.bodies.is_empty()) else {
        return Ok(Vec::new());
    };
    let names = system.bodies.iter().map(|body| body.name.as_str());
    same_names("body", configuration.bodies.keys(), names)?;
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

/// Kinds of inputs, for messages: those with voltages, then loads.
const KINDS: [&str; 2] = ["muscle or electrode", "load"];

/// Checks that names are those of the inputs of a kind that reach the scene.
fn same_inputs<T>(kind: usize, columns: &BTreeMap<String, T>, model: &Model) -> Result<()> {
    let inputs = model.reached.iter().map(|&s| &model.sources[s]);
    let inputs = inputs.filter(|source| usize::from(source.is_load()) == kind);
    let inputs = inputs.map(|source| source.name.as_str());
    same_names(KINDS[kind], columns.keys(), inputs)
}

fn same_names<'a>(
    what: &str,
    file: impl Iterator<Item = &'a String>,
    scene: impl Iterator<Item = &'a str>,
) -> Result<()> {
    let (file, scene): (Vec<_>, Vec<_>) = (file.collect(), scene.collect());
    let unknown = file.iter().find(|name| !scene.contains(&name.as_str()));
    let missing = scene
        .iter()
        .find(|name| !file.iter().any(|one| one.as_str() == **name));
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

fn same_length(name: &str, found: usize, expected: usize, of: &str) -> Result<()> {
    if found == expected {
        return Ok(());
    }
    Err(Reason::Contradiction(format!(
        "{name} has {found} values for {expected} {of}"
    )))
}
