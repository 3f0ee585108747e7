//! Writer of solution files: from a solution to `solution.json` and its arrays.

use std::collections::BTreeMap;
use std::io;

use crate::control::Solution;
use crate::files::lay_out;
use crate::files::solution::arrays;
use crate::files::solution::record::{
    Body, ConfigurationRecord, METRE, Multipliers, SECOND, SolutionRecord, StateRecord, unit,
};
use crate::model::Model;

/// A solution with more numbers than this has them in a file of arrays.
const MOST: usize = 200_000;

/// The texts of a solution.
#[derive(Clone, Debug, PartialEq)]
pub struct Written {
    /// Of `solution.json`.
    pub json: String,
    /// Bytes of the file of arrays next to it, where it has one.
    pub arrays: Option<Vec<u8>>,
}

/// The files of a solution; `arrays_file` would be the name of the second one.
///
/// # Errors
/// A name of the scene is too long for a file of arrays.
pub fn written(model: &Model, solved: &Solution, arrays_file: &str) -> io::Result<Written> {
    let mut file = record(model, solved);
    let arrays = (numbers(solved) > MOST)
        .then(|| arrays::taken(&mut file, arrays_file))
        .transpose()?;
    let json = serde_json::to_string(&file).expect("numbers and names are JSON");
    Ok(Written {
        json: lay_out(&json),
        arrays,
    })
}

/// Returns the approximate number of numbers.
fn numbers(solved: &Solution) -> usize {
    let rows = |rows: &[Vec<f64>]| rows.len() * rows.first().map_or(0, Vec::len);
    let poses = solved.poses.len() * solved.poses.first().map_or(0, Vec::len);
    let lists = [
        &solved.joints,
        &solved.z,
        &solved.voltages,
        &solved.potentials,
    ];
    12 * poses + lists.into_iter().map(|list| rows(list)).sum::<usize>()
}

/// Loads that hold the goal in N and N m, where one is not that of the last interval.
fn hold_loads(model: &Model, solved: &Solution) -> Option<BTreeMap<String, f64>> {
    let (held, last) = (solved.hold.as_ref()?, solved.voltages.last()?);
    let sources = model.system.sources();
    let loads = model.reached.iter().copied();
    let loads: Vec<usize> = loads.filter(|&s| sources[s].is_load()).collect();
    let differs = loads.iter().any(|&s| held[s] != last[s]);
    let value = |&s: &usize| (sources[s].name.clone(), held[s] / sources[s].kind.si().1);
    differs.then(|| loads.iter().map(value).collect())
}

/// Returns the record that is written.
fn record(model: &Model, solved: &Solution) -> SolutionRecord {
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
    let column = |&s: &usize| {
        let (_, unit) = sources[s].kind.si();
        let discrete = solved.voltages.iter().map(|row| row[s] / unit).collect();
        (sources[s].name.clone(), discrete)
    };
    let is_load = |s: &&usize| sources[**s].is_load();
    let driven = || model.reached.iter().filter(|s| !is_load(s));
    let loads: BTreeMap<_, _> = model.reached.iter().filter(is_load).map(column).collect();
    SolutionRecord {
        arrays: None,
        scene: system.name.clone(),
        time: solved.times.iter().map(|t| t / SECOND).collect(),
        joints: None,
        configuration: Some(ConfigurationRecord {
            bodies: bodies.map(|(b, it)| (it.name.clone(), body(b))).collect(),
            joints: joints.collect(),
        }),
        voltages: Some(driven().map(column).collect()),
        loads: (!loads.is_empty()).then_some(loads),
        hold: solved.hold.as_ref().map(|row| {
            let held = |&s: &usize| (sources[s].name.clone(), row[s]);
            driven().map(held).collect()
        }),
        hold_loads: hold_loads(model, solved),
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
            momentum: solved.momentum.clone(),
            meshes_mm: solved.meshes.clone(),
        }),
        costates: solved.costates.clone().map(|c| Multipliers {
            rows: c.rows,
            lower: c.lower,
            upper: c.upper,
        }),
        barrier: solved.barrier,
    }
}
