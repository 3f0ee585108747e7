//! Input and output of a command: its options, its answer, and common words.

use crate::app::progress::ProgressDisplay;
use crate::control::problem::Task;
use crate::files::is_standard_input;
use crate::report::atomic::folder;
use crate::report::origin::Origin;
use crate::report::{Figures, PageContent};
use crate::workflow::accuracy::AccuracyTarget;
use serde::{Deserialize, Serialize};
use std::ffi::OsString;
use std::path::{Path, PathBuf};

/// A command on a problem file, or on the file of a study or a sweep.
#[derive(Clone, Debug, Default)]
pub struct CommandInput {
    /// The command as typed.
    pub command: String,
    /// The problem file as typed; `-` for standard input.
    pub input: PathBuf,
    /// Overrides `path=value`.
    pub set: Vec<String>,
    /// Folder for the results; `results/<name of the problem>` where not given, see [`CommandInput::folder`].
    pub output: Option<PathBuf>,
    /// Seconds that the whole run may take.
    pub max_seconds: Option<f64>,
    /// Iterations that the solver may take, in place of those of the file.
    pub max_iterations: Option<usize>,
    /// Folder of the result from which the run is resumed.
    pub from: Option<PathBuf>,
    /// Target of the error of discretisation.
    pub wanted: Option<AccuracyTarget>,
    /// Viewpoint of figures, and further formats.
    pub figures: Figures,
    /// Display of progress.
    pub progress: ProgressDisplay,
    /// Writing of `report.html`.
    pub page: PageWanted,
    /// True if a result that is whole is not made again, where the run is one of a batch.
    pub once: bool,
}

/// Writing of a page.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PageWanted {
    /// It is written with the other files.
    #[default]
    Written,
    /// It is not written.
    LeftOut,
}

impl PageWanted {
    /// Returns the texts of the page, where it is written.
    pub(super) fn of(self, content: &PageContent) -> Option<&PageContent> {
        (self == Self::Written).then_some(content)
    }
}

/// The answer of a command.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CommandOutput {
    /// True if the task has an answer: exit status 0, otherwise 1.
    pub is_solved: bool,
    /// Text on standard output.
    pub result: String,
    /// Further notes, on standard error.
    pub notes: Vec<String>,
}

impl CommandInput {
    /// Folder for the results: that of the name of the file, or of its folder where the file is called `problem.json` or `scene.json`, as those of `new`.
    pub fn folder(&self) -> PathBuf {
        self.output.clone().unwrap_or_else(|| {
            let name = match is_standard_input(&self.input) {
                true => "stdin".into(),
                false => name(&self.input),
            };
            PathBuf::from("results").join(name)
        })
    }

    /// Words of a command on the same problem with the same overrides and folder.
    pub(crate) fn words(&self, command: &str) -> Vec<String> {
        let mut words = ["proboscis", command].map(str::to_owned).to_vec();
        words.push(self.input.display().to_string());
        let set = self.set.iter();
        words.extend(set.flat_map(|set| ["--set".to_owned(), set.clone()]));
        if let Some(folder) = &self.output {
            words.extend(["-o".to_owned(), folder.display().to_string()]);
        }
        words
    }

    /// Returns the origin of results; Ipopt is named where it has a part.
    pub fn origin(&self, with_ipopt: bool) -> Origin {
        Origin::new(&self.command, &self.input, with_ipopt)
    }
}

/// File names that do not identify a problem.
const GENERIC: [&str; 2] = ["problem", "scene"];

/// The name of a problem: that of its file, or of its folder.
fn name(input: &Path) -> OsString {
    let stem = input.file_stem().unwrap_or_default();
    let of_folder = || Some(folder(input).canonicalize().ok()?.file_name()?.to_owned());
    let is_generic = GENERIC.iter().any(|&name| stem == name);
    let name = is_generic.then(of_folder).flatten();
    name.unwrap_or_else(|| stem.to_owned())
}

/// A number with its noun.
pub(super) fn counted(count: usize, noun: &str) -> String {
    format!("{count} {noun}{}", if count == 1 { "" } else { "s" })
}

/// Key of a task in its file.
pub(super) fn key(task: &Task) -> &'static str {
    match task {
        Task::Control(_) | Task::Motions(_) => "control",
        Task::Simulate(_) => "simulate",
        Task::Equilibrium(..) => "equilibrium",
        Task::Identify(_) => "identify",
    }
}
