//! A solve as typed on the command line, and a process of it.

use std::ffi::OsString;
use std::fs::File;
use std::io;
use std::process::{Child, Command, Stdio};
use std::time::Instant;

use super::parent::bind;
use crate::app::progress::ProgressDisplay;
use crate::app::request::{CommandInput, PageWanted};
use crate::report::shell;
use crate::report::viewpoint::Viewpoint;

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
    let child = bind(&mut Command::new(std::env::current_exe()?))
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
