//! Runs that go on from the result of another: `--from`.

use std::path::{Path, PathBuf};

use serde_json::{Value, json};

use crate::app::error::CommandError;
use crate::app::kept::record::digest;
use crate::app::kept::solution_file;
use crate::app::request::CommandInput;
use crate::control::problem::{Simulation, Task};
use crate::dynamics::DiscreteTrajectory;
use crate::files::continuation::{Continuation, bytes, read};
use crate::files::{Loaded, is_standard_input};
use crate::report::atomic::{self, WriteError};
use crate::report::file_set::FileSet;
use crate::report::origin::Origin;
use crate::report::quoting;
use crate::workflow::integrate::grid;

/// A simulation that has ended, and one that has not.
pub(in crate::app) const ENDED: &str = "continuation.npz";
pub(in crate::app) const UNFINISHED: &str = "unfinished.npz";
/// Digits of the hash of a problem with the files that it names.
const DIGITS: usize = 32;
/// Steps that differ by no more than this part are equal.
const SAME_STEP: f64 = 1e-9;

/// Error: the run cannot be resumed from this folder.
fn wrong(reason: String) -> CommandError {
    CommandError::option("--from", reason)
}

/// The JSON text of a simulation without its end: a motion can be resumed where this is the same.
pub(in crate::app) fn asked(loaded: &Loaded, task: &Simulation) -> String {
    let mut task = task.clone();
    task.duration = 0.0;
    if task.tolerance.is_some() {
        // That of the first attempt is a part of the duration.
        task.step = 0.0;
    }
    let digest = digest(format_args!("{:?}{task:?}", loaded.system), DIGITS);
    let (program, digest) = (json!(Origin::program()), json!(digest));
    let simulate = loaded.entry_without("simulate", "duration");
    let scene = &loaded.scene;
    format!(
        "{{\"scene\":{scene},\"simulate\":{simulate},\"program\":{program},\"digest\":{digest}}}"
    )
}

/// The motion that a folder holds, where it is one of this problem that has not come to its end.
///
/// # Errors
/// There is none, or it is one of another problem.
pub(in crate::app) fn begun(
    folder: &Path,
    asked: &str,
    task: &Simulation,
) -> Result<DiscreteTrajectory, CommandError> {
    let paths = [UNFINISHED, ENDED].map(|name| folder.join(name));
    let Some(path) = paths.iter().find(|path| path.is_file()) else {
        let folder = folder.display();
        return Err(wrong(format!(
            "{folder} holds no simulation to go on with, which would be {ENDED}"
        )));
    };
    let file = path.display();
    let read = read(path).map_err(|error| wrong(format!("{file}: {error}")))?;
    let Continuation { discrete, problem } = read;
    let [problem, asked]: [Value; 2] =
        [&problem, asked].map(|text| serde_json::from_str(text).unwrap_or_default());
    if let Some(other) = difference(&problem, &asked) {
        return Err(wrong(format!(
            "{file} is a motion of another problem: {other}"
        )));
    }
    let (steps, h) = grid(task);
    let done = discrete.times.len() - 1;
    let reached = discrete.times[done];
    if reached > task.duration * (1.0 + SAME_STEP) {
        return Err(wrong(format!(
            "{file} has {} s of motion, and simulate.duration asks for {} s",
            reached / 1e3,
            task.duration / 1e3
        )));
    }
    let expected = done as f64 * h;
    if task.tolerance.is_none() && (reached - expected).abs() > SAME_STEP * reached {
        return Err(wrong(format!(
            "{file} has steps of {} ms; {steps} equal steps in {} s are of {h} ms: choose a simulate.duration of whole steps",
            reached / done as f64,
            task.duration / 1e3
        )));
    }
    Ok(discrete)
}

/// Adds the state from which a motion of the problem `asked` can be resumed to the files of a result; none where it cannot be.
pub(in crate::app) fn add(
    files: &mut FileSet,
    discrete: &DiscreteTrajectory,
    asked: Option<&str>,
) -> Result<(), WriteError> {
    let path = files.folder().join(ENDED);
    let bytes = asked.map(|asked| bytes(discrete, asked).map_err(WriteError::at(path)));
    files.put(ENDED, bytes.transpose()?)
}

/// Replaces the state of a motion that has not ended.
pub(in crate::app) fn replace(
    path: &Path,
    discrete: &DiscreteTrajectory,
    asked: &str,
) -> Result<(), WriteError> {
    let bytes = bytes(discrete, asked).map_err(WriteError::at(path))?;
    atomic::write(path, &bytes)
}

/// Returns the first difference of two problems, in words.
fn difference(other: &Value, asked: &Value) -> Option<String> {
    for key in ["scene", "simulate"] {
        if let Some(path) = first(&other[key], &asked[key], key) {
            return Some(format!("{path} is not the same"));
        }
    }
    if other["digest"] == asked["digest"] {
        return None;
    }
    let program = other["program"].as_str().unwrap_or("?");
    Some(match asked["program"].as_str() == Some(program) {
        true => "a file that it names has changed".to_owned(),
        false => format!("proboscis {program} has made it"),
    })
}

/// The path of the first entry that differs.
fn first(a: &Value, b: &Value, path: &str) -> Option<String> {
    match (a, b) {
        (Value::Object(a), Value::Object(b)) => {
            let keys = a.keys().chain(b.keys().filter(|key| !a.contains_key(*key)));
            let null = &Value::Null;
            let mut differing = keys.filter_map(|key| {
                let [a, b] = [a, b].map(|entries| entries.get(key).unwrap_or(null));
                first(a, b, &format!("{path}.{key}"))
            });
            differing.next()
        }
        (Value::Array(a), Value::Array(b)) if a.len() == b.len() => {
            let mut pairs = a.iter().zip(b).enumerate();
            pairs.find_map(|(i, (a, b))| first(a, b, &format!("{path}[{i}]")))
        }
        _ => (a != b).then(|| path.to_owned()),
    }
}

/// The solution that a folder holds: of a solve that has not come to its end the last one that was kept.
///
/// # Errors
/// There is none.
pub(in crate::app) fn solution(folder: &Path) -> Result<PathBuf, CommandError> {
    let paths = [solution_file::UNFINISHED, solution_file::NAME].map(|name| folder.join(name));
    let found = paths.into_iter().find(|path| path.is_file());
    let folder = folder.display();
    found.ok_or_else(|| wrong(format!("{folder} holds no solution.json to go on from")))
}

/// The command that resumes a run that was stopped.
pub(in crate::app) fn command(request: &CommandInput, task: &Task) -> Option<String> {
    let command = match task {
        Task::Control(_) | Task::Motions(_) => "solve",
        Task::Simulate(_) => "simulate",
        Task::Equilibrium(_) | Task::Identify(_) => return None,
    };
    // What came through a pipe has gone.
    if is_standard_input(&request.input) {
        return None;
    }
    let mut words = request.words(command);
    words.extend(["--from".to_owned(), request.folder().display().to_string()]);
    Some(format!("to go on: {}", quoting::command(words)))
}
