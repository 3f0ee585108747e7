//! A result that is made once: a folder that holds it already, whole, is left as it is.

use std::fs;
use std::path::Path;

use serde::{Deserialize, Serialize};

use crate::app::error::CommandError;
use crate::app::identity::Identity;
use crate::app::record::{Ending, FileRecords, Found, OF_RUN};
use crate::app::request::{CommandInput, CommandOutput};
use crate::app::task::{read, run};
use crate::files::lay_out;
use crate::report::atomic::{self, WriteError};

/// The answer of a run that has come to its end, with its files.
#[derive(Debug, PartialEq, Serialize, Deserialize)]
struct Record {
    identity: String,
    is_solved: bool,
    result: String,
    notes: Vec<String>,
    files: FileRecords,
}

/// Does what a problem file asks for, unless the folder of the results holds the answer already; a result of which a file is missing or
/// not as it was written is made again.
///
/// # Errors
/// As of [`run`].
pub fn run_once(request: &CommandInput) -> Result<CommandOutput, CommandError> {
    let loaded = read(&request.input, None, &request.set)?;
    let identity = Identity::of_run(&loaded, request);
    let folder = request.folder();
    let deviation = match found(&folder, &identity) {
        Found::Whole(record) => {
            return Ok(CommandOutput {
                is_solved: record.is_solved,
                result: format!("found as it was written: {}", record.result),
                notes: record.notes,
            });
        }
        Found::Deviates(deviation) => Some(deviation),
        Found::Nothing => None,
    };
    let mut output = run(request)?;
    if Ending::of_folder(&folder).is_some_and(|ending| !ending.is_unfinished()) {
        write(&folder, &identity, &output)?;
    }
    let again = deviation.map(|words| format!("made again: {words}"));
    output.notes.splice(0..0, again);
    Ok(output)
}

/// Returns the result of a run that a folder holds.
fn found(folder: &Path, identity: &Identity) -> Found<Record> {
    let Ok(text) = fs::read_to_string(folder.join(OF_RUN)) else {
        return Found::Nothing;
    };
    let Ok(record) = serde_json::from_str::<Record>(&text) else {
        return Found::Deviates(format!("{OF_RUN} is no record"));
    };
    if record.identity != identity.as_str() {
        return Found::Nothing;
    }
    match record.files.deviation(folder) {
        Some(words) => Found::Deviates(words),
        None => Found::Whole(record),
    }
}

fn write(folder: &Path, identity: &Identity, output: &CommandOutput) -> Result<(), WriteError> {
    let path = folder.join(OF_RUN);
    let files = FileRecords::from_folder(folder).map_err(|cause| WriteError {
        path: path.clone(),
        cause,
    })?;
    let record = Record {
        identity: identity.as_str().to_owned(),
        is_solved: output.is_solved,
        result: output.result.clone(),
        notes: output.notes.clone(),
        files,
    };
    let text = serde_json::to_string(&record).expect("words and numbers are JSON");
    atomic::write(&path, lay_out(&text).as_bytes())
}
