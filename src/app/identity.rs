//! Identity of a problem, and of the run of a result.

use std::fmt;
use std::fs;
use std::path::Path;

use crate::app::content_hash::{digest, digest_of};
use crate::app::request::CommandInput;
use crate::control::problem::{Control, Guess, Task};
use crate::files::Loaded;
use crate::files::solution::file_beside;
use crate::report::origin::Origin;

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
