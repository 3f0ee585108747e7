//! A solve as typed on the command line, and a process of it.
//!
//! End of the processes of a batch with the program that started them, however that ends.
//!
//! The program holds one end of a pipe, of which the other one is the standard input of the process. The operating system closes
//! what a program held when it is gone, also after `kill -9`, and the process reads the end of its input. Nothing is sent.

use crate::app::batch::end::RunIn;
use crate::app::progress::ProgressDisplay;
use crate::app::request::{CommandInput, PageWanted};
use crate::report::shell;
use crate::report::viewpoint::Viewpoint;
use crate::stop;
use std::ffi::OsString;
use std::fs::File;
use std::path::Path;
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
        command: shell::command(&typed),
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
