//! What is typed and what is told: a command with its options, and its answer.

use std::ffi::OsStr;
use std::path::PathBuf;

use crate::app::progress::ProgressDisplay;
use crate::files::is_standard_input;
use crate::report::origin::Origin;
use crate::report::{Figures, Told};
use crate::workflow::accuracy::AccuracyTarget;

/// A command on a problem file.
#[derive(Clone, Debug)]
pub struct CommandInput {
    /// The command as typed.
    pub command: String,
    /// The problem file as typed; `-` for standard input.
    pub input: PathBuf,
    /// Overrides `path=value`.
    pub set: Vec<String>,
    /// Folder for the results; `results/<name of the problem>` where not given.
    pub output: Option<PathBuf>,
    /// Seconds that the whole run may take.
    pub max_seconds: Option<f64>,
    /// Iterations that the solver may take, in place of those of the file.
    pub max_iterations: Option<usize>,
    /// Folder of the result from which the run goes on.
    pub from: Option<PathBuf>,
    /// What is asked about the error of discretisation.
    pub wanted: Option<AccuracyTarget>,
    /// How figures look, and what is written besides.
    pub figures: Figures,
    /// Whether progress is shown.
    pub progress: ProgressDisplay,
    /// Whether `report.html` is written.
    pub page: PageWanted,
}

/// Whether a page is written.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PageWanted {
    /// With the other files.
    #[default]
    Written,
    /// Nobody wants it.
    LeftOut,
}

impl PageWanted {
    /// What the page says, where it is written.
    pub(super) fn of(self, told: &Told) -> Option<&Told> {
        (self == Self::Written).then_some(told)
    }
}

/// The answer of a command.
#[derive(Clone, Debug, PartialEq)]
pub struct CommandOutput {
    /// Whether the question has an answer: exit status 0, otherwise 1.
    pub is_solved: bool,
    /// What goes to standard output.
    pub result: String,
    /// What else there is to say, on standard error.
    pub notes: Vec<String>,
}

impl CommandInput {
    /// Folder for the results.
    pub fn folder(&self) -> PathBuf {
        self.output.clone().unwrap_or_else(|| {
            let stem = match is_standard_input(&self.input) {
                true => OsStr::new("stdin"),
                false => self.input.file_stem().unwrap_or_default(),
            };
            PathBuf::from("results").join(stem)
        })
    }

    /// Where results come from; Ipopt is named where it has a part.
    pub fn origin(&self, with_ipopt: bool) -> Origin {
        Origin {
            command: self.command.clone(),
            input: self.input.display().to_string(),
            version: Origin::program(),
            ipopt: if with_ipopt {
                crate::ipopt::VERSION.to_owned()
            } else {
                String::new()
            },
        }
    }
}
