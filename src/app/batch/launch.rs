//! A solve as typed on the command line, a process of it, and its end; the engines that run solves.
//!
//! End of the processes of a batch with the program that started them, however that ends.
//!
//! The program holds one end of a pipe, of which the other one is the standard input of the process. The operating system closes
//! what a program held when it is gone, also after `kill -9`, and the process reads the end of its input. Nothing is sent.

use crate::app::kept::record::{WrittenSeconds, WrittenSummary};
use crate::app::progress::ProgressDisplay;
use crate::app::request::{CommandInput, PageWanted};
use crate::files::Loaded;
use crate::ipopt::Options;
use crate::report::quoting;
use crate::report::viewpoint::Viewpoint;
use crate::stop;
use clap::ValueEnum;
use serde::Serialize;
use std::ffi::OsString;
use std::fs::File;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::Instant;
use std::{env, io, process, thread};

/// A solve that runs.
pub(super) struct Running {
    pub(super) index: usize,
    pub(super) child: Child,
    pub(super) told: File,
    pub(super) began: Instant,
}

/// The solve as if it had been typed by itself.
pub(super) fn as_typed(request: CommandInput) -> CommandInput {
    let typed = words(&request);
    let typed = typed.iter().map(|word| word.to_string_lossy());
    let typed: Vec<_> = ["proboscis".into()].into_iter().chain(typed).collect();
    CommandInput {
        command: quoting::command(&typed),
        progress: ProgressDisplay::Never,
        ..request
    }
}

/// Returns the words of the command line of a solve.
pub(super) fn words(request: &CommandInput) -> Vec<OsString> {
    let mut words: Vec<OsString> = vec!["solve".into(), request.input.clone().into()];
    let mut option = |name: &str, value: OsString| words.extend([name.into(), value]);
    for change in &request.set {
        option("--set", change.into());
    }
    option("-o", request.folder().into());
    if let Some(iterations) = request.max_iterations {
        option("--max-iterations", iterations.to_string().into());
    }
    if let Some(seconds) = request.max_seconds {
        option("--max-seconds", seconds.to_string().into());
    }
    if request.figures.view != Viewpoint::default() {
        option("--view", request.figures.view.word().into());
    }
    if request.figures.gltf {
        option("--export", "gltf".into());
    }
    if request.figures.parts {
        option("--export", "paraview".into());
    }
    if request.page == PageWanted::LeftOut {
        words.push("--no-report".into());
    }
    if request.once {
        words.push("--once".into());
    }
    words.push("--quiet".into());
    words
}

/// Starts the process of a solve.
pub(super) fn launch(command: &CommandInput, index: usize) -> io::Result<Running> {
    let told = tempfile::tempfile()?;
    let child = bind(&mut Command::new(env::current_exe()?))
        .args(words(command))
        .stdout(Stdio::null())
        .stderr(told.try_clone()?)
        .spawn()?;
    Ok(Running {
        index,
        child,
        told,
        began: Instant::now(),
    })
}

/// The environment variable that says so to a process.
const NAME: &str = "PROBOSCIS_ENDS_WITH_ITS_INPUT";

/// Exit status of a process that nobody waits for.
const EXIT_STATUS: i32 = 1;

/// A command whose process ends with this one.
pub(super) fn bind(command: &mut Command) -> &mut Command {
    command.env(NAME, "1").stdin(Stdio::piped())
}

/// Lets this process end with the program that started it, where it is one of a batch.
pub fn end_with_parent() {
    if env::var_os(NAME).is_none() {
        return;
    }
    let watch = || {
        // Nothing comes before the end.
        io::copy(&mut io::stdin().lock(), &mut io::sink()).ok();
        process::exit(EXIT_STATUS);
    };
    if let Err(error) = thread::Builder::new().spawn(watch) {
        tracing::warn!("this process will not end with the one that started it: {error}");
    }
}

/// Solves, each with a folder of its own.
#[derive(Debug)]
pub(crate) struct Batch<'a> {
    /// Solves.
    pub(crate) runs: &'a [CommandInput],
    /// Text that stands for that of the problem file, in threads.
    pub(crate) text: Option<&'a str>,
    /// Engine.
    pub(crate) run_in: RunIn,
    /// Folder of all results.
    pub(crate) folder: &'a Path,
    /// Seconds that all of them may take together.
    pub(crate) max_seconds: Option<f64>,
    /// Time at which the command began.
    pub(crate) began: Instant,
}

impl Batch<'_> {
    /// A solve in the time that is left; none after Ctrl-C or at the end of that time.
    pub(super) fn command(&self, run: &CommandInput) -> Option<CommandInput> {
        self.may_go_on().then(|| {
            as_typed(CommandInput {
                max_seconds: self.left(),
                ..run.clone()
            })
        })
    }

    /// Returns true if there is time left and Ctrl-C was not pressed.
    pub(super) fn may_go_on(&self) -> bool {
        !stop::requested() && self.left().is_none_or(|left| left > 0.0)
    }

    /// Seconds that are left.
    fn left(&self) -> Option<f64> {
        let spent = self.began.elapsed().as_secs_f64();
        self.max_seconds.map(|limit| limit - spent)
    }
}

/// Engine that runs the solves of a batch.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, ValueEnum)]
#[serde(rename_all = "snake_case")]
pub enum RunIn {
    /// In threads of this process; in processes where MUMPS solves the linear systems of a control problem.
    Threads,
    /// In this process: in threads, where the linear solver allows that, one after the other elsewhere.
    #[value(skip)]
    Here,
    /// One after the other, in this process.
    #[value(skip)]
    InTurn,
    /// Each in a process of its own.
    Processes,
    /// Each as a task of the HyperQueue server that runs, on whatever workers it has.
    #[serde(rename = "hyperqueue")]
    #[value(name = "hyperqueue")]
    HyperQueue,
}

impl RunIn {
    /// The same for solves that may run in parallel with others in one process or not.
    pub(crate) fn of_tasks(self, run_at_once: bool) -> Self {
        match self {
            Self::Threads if !run_at_once => Self::Processes,
            Self::Here if run_at_once => Self::Threads,
            Self::Here => Self::InTurn,
            other => other,
        }
    }
}

/// Returns true if the task of a problem may run in parallel with others in one process.
pub(crate) fn task_runs_at_once(loaded: &Loaded) -> bool {
    let Some(task) = loaded.task.motions(&loaded.system) else {
        return true;
    };
    let solver = &task.motions[0].control.solver;
    let options = Options {
        linear_solver: solver.linear_solver,
        extra: solver.ipopt.clone(),
        ..Options::default()
    };
    options.run_at_once()
}

/// The end of a solve, as of a process.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct RunEnd {
    /// Exit status, see [`CommandError::exit_status`](crate::app::CommandError::exit_status); none where a signal or a panic ended it.
    pub(super) status: Option<i32>,
    /// Its words on standard error.
    pub(super) words: String,
    /// Wall time in s.
    pub(super) seconds: f64,
}

/// Takes the end of the solve with an index; none where there was no time for it.
pub(super) type EndObserver<'a> = &'a mut dyn FnMut(usize, Option<RunEnd>) -> ControlFlow<()>;

/// A solve that has ended, with what it left in its folder.
#[derive(Debug)]
pub(crate) struct Ended {
    /// True if its question has an answer.
    pub(crate) is_solved: bool,
    /// Message where it left no summary.
    pub(crate) message: Option<String>,
    /// Its summary; where it left none, status and time alone: `not_started`, `refused`, `interrupted`, `failed`.
    pub(crate) summary: WrittenSummary,
    /// Folder of its results, where it left a summary.
    pub(crate) folder: Option<PathBuf>,
}

impl Ended {
    /// One that ended like this in a folder.
    pub(super) fn new(end: Option<RunEnd>, folder: &Path) -> Self {
        let Some(end) = end else {
            return Self::without_results("not_started", "", 0.0);
        };
        let is_written = matches!(end.status, Some(0 | 1));
        let written = is_written.then(|| Self::of_folder(folder, end.status == Some(0)));
        if let Some(written) = written.flatten() {
            return written;
        }
        let words = end.words.trim_end();
        let words = words.strip_prefix("error: ").unwrap_or(words);
        let (status, message) = match end.status {
            Some(2) => ("refused", words),
            _ if stop::requested() => ("interrupted", ""),
            Some(0) => ("failed", ""),
            _ => ("failed", words),
        };
        Self::without_results(status, message, end.seconds)
    }

    /// One that left a summary in a folder.
    pub(crate) fn of_folder(folder: &Path, is_solved: bool) -> Option<Self> {
        Some(Self {
            is_solved,
            message: None,
            summary: WrittenSummary::of_folder(folder)?,
            folder: Some(folder.to_owned()),
        })
    }

    /// One that left nothing.
    pub(crate) fn without_results(status: &str, message: &str, seconds: f64) -> Self {
        Self {
            is_solved: false,
            message: (!message.is_empty()).then(|| message.to_owned()),
            summary: WrittenSummary {
                status: status.to_owned(),
                seconds: WrittenSeconds { total: seconds },
                ..WrittenSummary::default()
            },
            folder: None,
        }
    }
}
