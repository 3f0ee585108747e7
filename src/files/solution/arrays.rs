//! The arrays of a long solution in a file of their own.

use std::path::Path;
use std::{fs, io, mem};

use serde::Deserialize;
use serde_json::Value;

use crate::files::json::path::Step;
use crate::files::json::tree::{Json, Tree};
use crate::files::npz::{self, NpzWriter};
use crate::files::solution::record::{ArraysOf, SolutionRecord};

/// Names of arrays that end with a name of the scene.
const OF_NAMES: [&str; 3] = ["voltages/", "loads/", "configuration/joints/"];
/// Begins the names of arrays of bodies.
const OF_BODIES: &str = "configuration/bodies/";

/// Moves the arrays out of a record, into the bytes of a file of this name.
///
/// # Errors
/// A name of the scene is too long for them.
pub(super) fn taken(file: &mut SolutionRecord, name: &str) -> io::Result<Vec<u8>> {
    let mut arrays = NpzWriter::default();
    arrays.list("time", &mem::take(&mut file.time));
    for (name, values) in file.voltages.take().into_iter().flatten() {
        arrays.list(&format!("voltages/{name}"), &values);
    }
    for (name, values) in file.loads.take().into_iter().flatten() {
        arrays.list(&format!("loads/{name}"), &values);
    }
    if let Some(configuration) = file.configuration.take() {
        for (name, values) in configuration.joints {
            arrays.list(&format!("configuration/joints/{name}"), &values);
        }
        for (name, body) in configuration.bodies {
            let instants = body.centre.len();
            let of = |what: &str| format!("{OF_BODIES}{name}/{what}");
            let centres = body.centre.as_flattened().iter().copied();
            arrays.array(&of("centre"), &[instants, 3], centres);
            let directors = body.directors.as_flattened().as_flattened().iter().copied();
            arrays.array(&of("directors"), &[instants, 3, 3], directors);
        }
    }
    if !file.potentials.is_empty() {
        arrays.rows("potentials", &mem::take(&mut file.potentials));
    }
    if let Some(state) = &mut file.state {
        arrays.list("state/times_ms", &mem::take(&mut state.times_ms));
        arrays.rows("state/z", &mem::take(&mut state.z));
        arrays.list("state/momentum", &mem::take(&mut state.momentum));
    }
    if let Some(costates) = file.costates.take() {
        arrays.list("costates/rows", &costates.rows);
        arrays.list("costates/lower", &costates.lower);
        arrays.list("costates/upper", &costates.upper);
    }
    let (bytes, digits) = arrays.finish()?;
    file.arrays = Some(ArraysOf {
        file: name.to_owned(),
        digits,
    });
    Ok(bytes)
}

/// Entry that names the file of arrays, if there is one.
#[derive(Deserialize)]
struct WithArrays {
    #[serde(default)]
    arrays: Option<ArraysOf>,
}

/// The name of the file of arrays that the solution at `path` has, where there is a solution with one.
pub(crate) fn file_beside(path: &Path) -> Option<String> {
    let read: WithArrays = serde_json::from_slice(&fs::read(path).ok()?).ok()?;
    Some(read.arrays?.file)
}

/// Puts the arrays that are wanted into the solution at `path`, where they would stand; it may have no file of arrays.
///
/// # Errors
/// The file cannot be used.
pub(crate) fn complete(
    path: &Path,
    solution: &mut Tree,
    is_wanted: impl Fn(&str) -> bool,
) -> Result<(), String> {
    let named = solution.json().entry("arrays").map(Json::read);
    let Some(Ok(Some(ArraysOf { file, digits }))) = named else {
        return Ok(());
    };
    let path = path.with_file_name(&file);
    let shown = format!("its arrays in {}", path.display());
    let read = npz::read(&path, is_wanted).map_err(|cause| format!("{shown}: {cause}"))?;
    if read.digits != digits {
        return Err(format!("{shown} were written with another solution"));
    }
    // A motion without a source has voltages of none.
    solution.put(&[Step::Key("voltages".to_owned())], "{}");
    for (name, array) in read.arrays {
        let value = value(&array.shape, &array.values).to_string();
        solution.put(&steps(&name), &value);
    }
    Ok(())
}

/// The keys that lead to an array.
fn steps(name: &str) -> Vec<Step> {
    let of_name = OF_NAMES
        .iter()
        .find_map(|&of| Some((of, name.strip_prefix(of)?)));
    let of_body = name
        .strip_prefix(OF_BODIES)
        .and_then(|rest| rest.rsplit_once('/'));
    let keys: Vec<&str> = match (of_name, of_body) {
        (Some((of, name)), _) => of.trim_end_matches('/').split('/').chain([name]).collect(),
        (None, Some((name, what))) => vec!["configuration", "bodies", name, what],
        (None, None) => name.split('/').collect(),
    };
    let key = |key: &str| Step::Key(key.to_owned());
    keys.into_iter().map(key).collect()
}

/// Numbers in rows.
fn value(shape: &[usize], values: &[f64]) -> Value {
    match shape {
        [] => values.first().map_or(Value::Null, |&number| number.into()),
        [_] => values.iter().map(|&number| Value::from(number)).collect(),
        [rows, within @ ..] => {
            let length: usize = within.iter().product();
            let row = |row: usize| value(within, &values[row * length..(row + 1) * length]);
            (0..*rows).map(row).collect()
        }
    }
}
