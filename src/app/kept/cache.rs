//! Skips a run whose complete result exists.

use crate::app::error::CommandError;
use crate::app::kept::record::{FileRecords, WrittenSummary, digest, digest_of};
use crate::app::request::{CommandInput, CommandOutput};
use crate::app::task::{read, run};
use crate::control::problem::{Control, Guess};
use crate::files::solution::file_beside;
use crate::files::{Loaded, lay_out};
use crate::report::atomic::{self, WriteError};
use crate::report::origin::Origin;
use serde::{Deserialize, Serialize};
use std::path::Path;
use std::{fmt, fs};

/// The record of a run in the folder of its result.
const NAME: &str = "record.json";

/// The answer of a run that has come to its end, with its files as they were written.
#[derive(Debug, Serialize, Deserialize)]
struct Record {
    identity: String,
    #[serde(flatten)]
    output: CommandOutput,
    files: FileRecords,
}

/// The answer of a run of this identity, where a folder has all of its result; none where it has another one, or none.
///
/// # Errors
/// A file is not as it was written, in words.
pub(crate) fn found(folder: &Path, identity: &str) -> Result<Option<CommandOutput>, String> {
    let Ok(text) = fs::read_to_string(folder.join(NAME)) else {
        return Ok(None);
    };
    let record = serde_json::from_str::<Record>(&text);
    let record = record.map_err(|_| format!("{NAME} is not as it was written"))?;
    if record.identity != identity {
        return Ok(None);
    }
    let deviation = record.files.deviation(folder);
    deviation.map_or(Ok(Some(record.output)), Err)
}

/// Does what a problem file asks for, unless the folder of the results holds the answer already; a result of which a file is missing or
/// not as it was written is made again.
///
/// # Errors
/// As of [`run`].
pub fn run_once(request: &CommandInput) -> Result<CommandOutput, CommandError> {
    let loaded = read(&request.input, None, &request.set)?;
    let identity = identity(&loaded, request);
    let folder = request.folder();
    let before = found(&folder, &identity);
    if let Ok(Some(output)) = before {
        let result = format!("found as it was written: {}", output.result);
        return Ok(CommandOutput { result, ..output });
    }
    // That there is no answer is one.
    let answer = run(request).or_else(|error| {
        let status = error.unanswered().map(|word| word.replace('_', " "));
        let notes = vec![error.to_string()];
        let output = |result| CommandOutput {
            is_solved: false,
            result,
            notes,
        };
        status.map(output).ok_or(error)
    });
    let mut output = answer?;
    if WrittenSummary::of_folder(&folder).is_some_and(|summary| !summary.is_unfinished()) {
        write(&folder, identity, &output)?;
    }
    let again = before.err().map(|words| format!("made again: {words}"));
    output.notes.splice(0..0, again);
    Ok(output)
}

/// Writes the record of a run, with the hashes of the files that the folder has now.
fn write(folder: &Path, identity: String, output: &CommandOutput) -> Result<(), WriteError> {
    let path = folder.join(NAME);
    let files = FileRecords::from_folder(folder, NAME).map_err(WriteError::at(&path))?;
    let record = Record {
        identity,
        output: output.clone(),
        files,
    };
    let text = serde_json::to_string(&record).expect("words and numbers are JSON");
    atomic::write(&path, lay_out(&text).as_bytes())
}

/// Digits of an identity.
const DIGITS: usize = 16;

/// Hexadecimal digits of a hash of a problem as it was read, with the files that it names, of the options of a run that have a part in
/// its files, and of the version of the program.
pub(crate) fn identity(loaded: &Loaded, request: &CommandInput) -> String {
    // All numbers are written so that they read back identical.
    let Loaded {
        system,
        task,
        output,
        disturbed,
        ..
    } = loaded;
    let CommandInput {
        max_iterations,
        wanted,
        figures,
        page,
        ..
    } = request;
    let motions = task.motions(system).into_iter();
    let motions = motions.flat_map(|task| task.motions);
    // Hashes of the files of earlier solutions from which it starts.
    let earlier: Vec<String> = motions.flat_map(|one| of_guess(one.control)).collect();
    hash(format_args!(
        "{system:?}{task:?}{output:?}{earlier:?}{disturbed:?}{max_iterations:?}{wanted:?}{figures:?}{page:?}"
    ))
}

/// The same of overrides that make no problem.
pub(crate) fn identity_of_words(words: &[String]) -> String {
    hash(format_args!("{words:?}"))
}

fn hash(written: fmt::Arguments<'_>) -> String {
    let program = Origin::program();
    digest(format_args!("{program}\n{written}"), DIGITS)
}

/// Hashes of the files of the solution that a problem starts from.
fn of_guess(control: &Control) -> Vec<String> {
    let Guess::Solution(earlier) = &control.guess else {
        return Vec::new();
    };
    let Some(path) = earlier.file() else {
        return Vec::new();
    };
    let arrays = file_beside(path).map(|name| path.with_file_name(name));
    let of_file = |path: &Path| fs::read(path).map_or_else(|_| String::new(), |b| digest_of(&b));
    [Some(path.to_owned()), arrays]
        .into_iter()
        .flatten()
        .map(|path| of_file(&path))
        .collect()
}
