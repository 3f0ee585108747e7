//! Skips a run whose complete result exists.

use crate::app::error::CommandError;
use crate::app::kept::record::{
    FileRecords, FolderRecord, Found, OF_RUN, WrittenSummary, digest, digest_of,
};
use crate::app::request::{CommandInput, CommandOutput};
use crate::app::task::{read, run};
use crate::control::problem::{Control, Guess, Task};
use crate::files::Loaded;
use crate::files::solution::file_beside;
use crate::report::origin::Origin;
use serde::{Deserialize, Serialize};
use std::path::Path;
use std::{fmt, fs};

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
    let deviation = match Record::found(&folder, identity.as_str()) {
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
    if WrittenSummary::of_folder(&folder).is_some_and(|summary| !summary.is_unfinished()) {
        let mut record = Record {
            identity: identity.as_str().to_owned(),
            is_solved: output.is_solved,
            result: output.result.clone(),
            notes: output.notes.clone(),
            files: FileRecords::default(),
        };
        record.write(&folder)?;
    }
    let again = deviation.map(|words| format!("made again: {words}"));
    output.notes.splice(0..0, again);
    Ok(output)
}

impl FolderRecord for Record {
    const NAME: &'static str = OF_RUN;

    fn identity(&self) -> &str {
        &self.identity
    }

    fn files(&mut self) -> &mut FileRecords {
        &mut self.files
    }
}

/// Digits of an identity.
const DIGITS: usize = 16;

/// Hexadecimal digits of a hash of a problem as it was read, with the files that it names, and of the version of the program.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Identity(String);

impl Identity {
    /// Identity of a problem, with the output of its motion.
    pub(crate) fn of_problem(loaded: &Loaded) -> Self {
        // All numbers are written so that they read back identical.
        let Loaded {
            system,
            task,
            output,
            disturbed,
            ..
        } = loaded;
        let earlier = earlier(task);
        let disturbed = match &disturbed[..] {
            [] => String::new(),
            parts => format!("{parts:?}"),
        };
        Self::from_text(format_args!(
            "{system:?}{task:?}{output:?}{earlier:?}{disturbed}"
        ))
    }

    /// Of a problem with the options of a run that have a part in its files.
    pub(crate) fn of_run(loaded: &Loaded, request: &CommandInput) -> Self {
        let CommandInput {
            max_iterations,
            wanted,
            figures,
            page,
            ..
        } = request;
        let Self(problem) = Self::of_problem(loaded);
        Self::from_text(format_args!(
            "{problem}{max_iterations:?}{wanted:?}{figures:?}{page:?}"
        ))
    }

    /// Of overrides that make no problem.
    pub(crate) fn of_words(words: &[String]) -> Self {
        Self::from_text(format_args!("{words:?}"))
    }

    fn from_text(written: fmt::Arguments<'_>) -> Self {
        let program = Origin::program();
        Self(digest(format_args!("{program}\n{written}"), DIGITS))
    }

    /// Its digits.
    pub(crate) fn as_str(&self) -> &str {
        &self.0
    }
}

/// Hashes of the files of an earlier solution from which a task starts.
fn earlier(task: &Task) -> Vec<String> {
    let controls: Vec<&Control> = match task {
        Task::Control(control) => vec![control],
        Task::Motions(motions) => motions.list.iter().map(|one| &one.control).collect(),
        Task::Simulate(_) | Task::Equilibrium(_) | Task::Identify(_) => Vec::new(),
    };
    controls.into_iter().flat_map(of_guess).collect()
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
