//! Errors of commands: the input is wrong, or a file cannot be written.

use std::error::Error as StdError;
use std::io;
use std::path::{Path, PathBuf};

use thiserror::Error;

use crate::files::SceneError;
use crate::files::urdf::UrdfError;
use crate::report::atomic::WriteError;
use crate::stop::Stopped;
use crate::workflow::WorkflowError;

/// A command ends without an answer.
#[derive(Debug, Error)]
pub enum CommandError {
    /// A scene, problem or override is wrong.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// A URDF file is wrong.
    #[error(transparent)]
    Urdf(#[from] UrdfError),
    /// An earlier solution cannot be used.
    #[error(transparent)]
    Earlier(Box<dyn StdError + Send + Sync>),
    /// The problem asks for something that does not exist.
    #[error("{}: {place}: {reason}", file.display())]
    Problem {
        /// The problem file as typed.
        file: PathBuf,
        /// Path in it.
        place: String,
        /// Reason.
        reason: String,
    },
    /// The input is right, but a start or goal at rest was not found.
    #[error("{}: {place}: {reason}", file.display())]
    NoEquilibrium {
        /// The problem file as typed.
        file: PathBuf,
        /// Path in it.
        place: String,
        /// Reason.
        reason: String,
    },
    /// The input is right, but the problem that a controller plans anew was not solved.
    #[error("{}: {place}: {reason}", file.display())]
    Unsolved {
        /// The problem file as typed.
        file: PathBuf,
        /// Path in it.
        place: String,
        /// Reason.
        reason: String,
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
    /// Exit status of the program: 2 where the input is wrong, 1 where it has no answer, there was no time, or results could not
    /// be kept.
    pub fn exit_status(&self) -> u8 {
        match self {
            Self::Write(_)
            | Self::Unreadable { .. }
            | Self::Stopped(_)
            | Self::Engine(_)
            | Self::NoEquilibrium { .. }
            | Self::Unsolved { .. } => 1,
            _ => 2,
        }
    }

    /// Path of the wrong entry, such as `scene.muscles[1].from.body`; empty where the problem as a whole is wrong, or something else.
    pub fn place(&self) -> &str {
        match self {
            Self::Scene(mistake) => mistake.path(),
            Self::Problem { place, .. }
            | Self::NoEquilibrium { place, .. }
            | Self::Unsolved { place, .. } => place,
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
            WorkflowError::Problem { place, reason } => Self::Problem {
                file: file.clone(),
                place,
                reason,
            },
            WorkflowError::NoEquilibrium { place, reason } => Self::NoEquilibrium {
                file: file.clone(),
                place,
                reason,
            },
            WorkflowError::Unsolved { place, reason } => Self::Unsolved {
                file: file.clone(),
                place,
                reason,
            },
            WorkflowError::Earlier(error) => Self::Earlier(error),
            WorkflowError::Stopped(stopped) => stopped.into(),
        }
    }
}
