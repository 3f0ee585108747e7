//! Reader of solution files: from a file to a solution of a model.

use std::borrow::Cow;
use std::collections::{BTreeMap, BTreeSet};
use std::error::Error;
use std::path::{Path, PathBuf};

use crate::control::{Costates, EarlierSolution, Solution};
use crate::files::json::document::Document;
use crate::files::json::scope::{Result, Scope, refuse};
use crate::files::solution::arrays::complete;
use crate::files::solution::record::{
    Body, Columns, ConfigurationRecord, METRE, SolutionRecord, StateRecord, unit,
};
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

/// The file as a document for messages, and what it says, with those arrays that are wanted.
pub(crate) fn record(
    path: &Path,
    is_wanted: impl Fn(&str) -> bool,
) -> Result<(Document, SolutionRecord)> {
    let mut document = Document::read(path)?;
    if let Err(reason) = complete(path, &mut document.tree, is_wanted) {
        let place = Scope::of(&document).key("arrays");
        return Err(place.wrong(reason, "the file that was written with it"));
    }
    let record = document.parse()?;
    Ok((document, record))
}

/// Reads a `solution.json` of the scene of a model.
///
/// # Errors
/// The file is no solution, or one of another scene.
pub fn read(path: &Path, model: &Model) -> Result<Solution> {
    let (document, file) = record(path, |_| true)?;
    let at = &Scope::of(&document);
    let times = file.times(at)?;
    refuse!(if times.len() < 2, at.key("time");
        found format!("{} instants", times.len()), expected "2 instants or more");
    let (system, instants) = (&model.system, times.len());
    let missing = || at.missing_key("voltages");
    let voltages = file.voltages.as_ref().ok_or_else(missing)?;
    same_inputs(0, voltages, model, &at.key("voltages"))?;
    let loads = file.loads.clone().unwrap_or_default();
    same_inputs(1, &loads, model, &at.key("loads"))?;
    let joints = joint_rows(&file, system, at)?;
    let voltages = input_rows([voltages, &loads], model, instants - 1, at)?;
    let hold = at.optional("hold", &file.hold, |place, held| {
        let loads = file.hold_loads.as_ref();
        same_inputs(0, held, model, place)?;
        if let Some(loads) = loads {
            same_inputs(1, loads, model, &at.key("hold_loads"))?;
        }
        Ok(hold(held, loads, voltages.last(), model))
    })?;
    let place = at.key("configuration").key("bodies");
    let poses = poses(file.configuration.as_ref(), system, instants, &place)?;
    let coordinates = coordinates(file.coordinates.as_deref(), model, at)?;
    let state = match file.state {
        Some(state) => checked_state(state, coordinates, model, instants, &at.key("state"))?,
        None => state_of_joints(times, &joints, model),
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

/// Coordinates by instant and joint, in the units inside: one column for each joint of the scene that has a coordinate.
fn joint_rows(file: &SolutionRecord, system: &System, at: &Scope<'_>) -> Result<Vec<Vec<f64>>> {
    let (columns, keys) = file.joint_columns(at)?;
    let at = keys.iter().fold(at.clone(), |at, key| at.key(key));
    let named = |joint: &&Joint| joint.has_coordinate();
    let joints = system.joints.iter().filter(named).map(|j| j.name.as_str());
    same_names("joint", columns.keys(), joints, &at)?;
    let instants = file.time.len();
    let mut rows = vec![vec![0.0; system.joints.len()]; instants];
    for (name, column) in columns {
        same_length(column.len(), instants, "instant", &at.key(name))?;
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
    at: &Scope<'_>,
) -> Result<Vec<Vec<f64>>> {
    let sources = &model.sources;
    let mut rows = vec![vec![0.0; sources.len()]; intervals];
    for &s in &model.reached {
        let Source { name, kind, .. } = &sources[s];
        let (key, columns) = match sources[s].is_load() {
            true => ("loads", loads),
            false => ("voltages", voltages),
        };
        let column = &columns[name];
        same_length(column.len(), intervals, "interval", &at.key(key).key(name))?;
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
) -> Vec<f64> {
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
    model.sources.iter().enumerate().map(value).collect()
}

/// Coordinates that a file names, or those of the model.
fn coordinates(word: Option<&str>, model: &Model, at: &Scope<'_>) -> Result<Coordinates> {
    word.map_or(Ok(model.coordinates), |word| {
        let expected = "\"reduced\" or \"redundant\"";
        let other = || at.key("coordinates").wrong(format!("{word:?}"), expected);
        Coordinates::named(word).ok_or_else(other)
    })
}

/// A state of the file, with a value for each instant, and rotations where its coordinates are those of the model.
fn checked_state(
    state: StateRecord,
    coordinates: Coordinates,
    model: &Model,
    instants: usize,
    at: &Scope<'_>,
) -> Result<StateRecord> {
    let place = at.key("z");
    let times = state.times_ms.len();
    same_length(times, instants, "instant", &at.key("times_ms"))?;
    same_length(state.z.len(), instants, "instant", &place)?;
    let map = &model.action.map;
    let is_wrong = |z: &Vec<f64>| !map.has_unit_charts(z);
    let wrong = state.z.iter().position(is_wrong);
    refuse!(if let Some(k) = wrong.filter(|_| coordinates == model.coordinates), place.index(k);
        found "a rotation whose quaternion does not have length one",
        expected "quaternions of length one");
    Ok(state)
}

/// State at given joint coordinates, of a file that has none.
fn state_of_joints(times_ms: Vec<f64>, joints: &[Vec<f64>], model: &Model) -> StateRecord {
    let z = joints.iter().map(|row| model.coordinates_at(row));
    StateRecord {
        times_ms,
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
    at: &Scope<'_>,
) -> Result<Vec<Vec<Pose>>> {
    let Some(configuration) = configuration.filter(|c| !c.bodies.is_empty()) else {
        return Ok(Vec::new());
    };
    let names = system.bodies.iter().map(|body| body.name.as_str());
    same_names("body", configuration.bodies.keys(), names, at)?;
    let mut poses = vec![vec![Pose::GROUND; system.bodies.len()]; instants];
    for (b, body) in system.bodies.iter().enumerate() {
        let Body { centre, directors } = &configuration.bodies[&body.name];
        for (key, found) in [("centre", centre.len()), ("directors", directors.len())] {
            same_length(found, instants, "instant", &at.key(&body.name).key(key))?;
        }
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
fn same_inputs<T>(
    kind: usize,
    columns: &BTreeMap<String, T>,
    model: &Model,
    at: &Scope<'_>,
) -> Result<()> {
    let inputs = model.reached.iter().map(|&s| &model.sources[s]);
    let inputs = inputs.filter(|source| usize::from(source.is_load()) == kind);
    let inputs = inputs.map(|source| source.name.as_str());
    same_names(KINDS[kind], columns.keys(), inputs, at)
}

fn same_names<'a>(
    what: &str,
    file: impl Iterator<Item = &'a String>,
    scene: impl Iterator<Item = &'a str>,
    at: &Scope<'_>,
) -> Result<()> {
    let file: BTreeSet<_> = file.map(String::as_str).collect();
    let scene: BTreeSet<_> = scene.collect();
    let unknown = file
        .difference(&scene)
        .map(|name| format!("this one has no {what} {name:?}"));
    let missing = scene.difference(&file);
    let missing = missing.map(|name| format!("the {what} {name:?} of this one is missing there"));
    refuse!(if let Some(why) = unknown.chain(missing).next(), at;
        found format!("a solution that belongs to another scene: {why}"),
        expected "one of this scene");
    Ok(())
}

fn same_length(found: usize, expected: usize, of: &str, at: &Scope<'_>) -> Result<()> {
    refuse!(if found != expected, at;
        found format!("{found} values"), expected format!("{expected}, one for each {of}"));
    Ok(())
}
