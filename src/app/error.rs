//! Errors of commands: the input is wrong, or a file cannot be written.

use std::error::Error as StdError;
use std::io;
use std::path::{Path, PathBuf};

use thiserror::Error;

use crate::files::SceneError;
use crate::report::atomic::WriteError;
use crate::stop::Stopped;
use crate::workflow::WorkflowError;

/// A command ends without an answer.
#[derive(Debug, Error)]
pub enum CommandError {
    /// A scene, problem, override or URDF file is wrong.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// An earlier solution cannot be used.
    #[error(transparent)]
    Earlier(Box<dyn StdError + Send + Sync>),
    /// A problem asks for something that does not exist, or is right and has no answer.
    #[error("{}: {error}", file.display())]
    InFile {
        /// The problem file as typed.
        file: PathBuf,
        /// The place in it, and the reason.
        error: WorkflowError,
    },
    /// A value typed on the command line is wrong.
    #[error("{option}: {reason}")]
    Option {
        /// The option.
        option: &'static str,
        /// Reason.
        reason: String,
    },
    /// One of several starts finds the input wrong.
    #[error("start {start}: {message}")]
    Start {
        /// Its number.
        start: usize,
        /// Its message.
        message: String,
    },
    /// Ctrl-C was pressed, or the time allowed is over, before there was anything to write.
    #[error("stopped before the first result ({0})")]
    Stopped(#[from] Stopped),
    /// A file stands where a new one was to be written.
    #[error("{} exists already and is left as it is; choose another folder", .0.display())]
    Exists(PathBuf),
    /// Results would replace those of another problem.
    #[error(
        "{} has results of {}, which those of {} would replace; expected another folder, by -o, or the same one by -o to replace them",
        folder.display(), input.display(), own.display()
    )]
    Foreign {
        /// The folder.
        folder: PathBuf,
        /// The problem file whose results are there.
        input: PathBuf,
        /// The one that was typed.
        own: PathBuf,
    },
    /// A result that was written cannot be read.
    #[error("cannot read {}: {cause}", file.display())]
    Unreadable {
        /// The file.
        file: PathBuf,
        /// Error of the operating system.
        cause: io::Error,
    },
    /// The program that hands solves to other machines stopped answering.
    #[error("HyperQueue: {0}; the same command goes on")]
    Engine(String),
    /// A file could not be written.
    #[error(transparent)]
    Write(#[from] WriteError),
}

impl CommandError {
    /// The error of a place in a problem file.
    pub(crate) fn problem(
        file: &Path,
        place: impl Into<String>,
        reason: impl Into<String>,
    ) -> Self {
        let (place, reason) = (place.into(), reason.into());
        Self::in_file(file)(WorkflowError::Problem { place, reason })
    }

    /// The error of an option.
    pub(crate) fn option(option: &'static str, reason: impl Into<String>) -> Self {
        let reason = reason.into();
        Self::Option { option, reason }
    }

    /// Status of a problem that is right, but has no state of rest to begin or end with, or no optimum that its controller follows.
    pub fn unanswered(&self) -> Option<&'static str> {
        let Self::InFile { error, .. } = self else {
            return None;
        };
        match error {
            WorkflowError::NoEquilibrium { .. } => Some("no_equilibrium"),
            WorkflowError::Unsolved { .. } => Some("plan_unsolved"),
            _ => None,
        }
    }

    /// Exit status of the program: 2 where the input is wrong, 1 where it has no answer, there was no time, or results could not
    /// be kept.
    pub fn exit_status(&self) -> u8 {
        match self {
            Self::Write(_) | Self::Unreadable { .. } | Self::Stopped(_) | Self::Engine(_) => 1,
            error if error.unanswered().is_some() => 1,
            _ => 2,
        }
    }

    /// Path of the wrong entry, such as `scene.muscles[1].from.body`; empty where the problem as a whole is wrong, or something else.
    pub fn place(&self) -> &str {
        match self {
            Self::Scene(mistake) => mistake.path(),
            Self::InFile { error, .. } => match error {
                WorkflowError::Problem { place, .. }
                | WorkflowError::NoEquilibrium { place, .. }
                | WorkflowError::Unsolved { place, .. } => place,
                WorkflowError::Earlier(_) | WorkflowError::Stopped(_) => "",
            },
            _ => "",
        }
    }

    /// The lines of the file around the error, marked, where there is such a place.
    pub fn excerpt(&self) -> Option<String> {
        match self {
            Self::Scene(mistake) => mistake.excerpt(),
            _ => None,
        }
    }

    /// Makes the error of a command from that of a workflow on the problem in a file.
    pub(crate) fn in_file(file: &Path) -> impl Fn(WorkflowError) -> Self {
        let file = file.to_owned();
        move |error| match error {
            WorkflowError::Earlier(error) => Self::Earlier(error),
            WorkflowError::Stopped(stopped) => stopped.into(),
            error => Self::InFile {
                file: file.clone(),
                error,
            },
        }
    }
}
