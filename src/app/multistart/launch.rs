//! The command of one start, and a process of it.

use crate::app::progress::ProgressDisplay;
use crate::app::request::CommandInput;
use std::ffi::OsString;
use std::fs::File;
use std::io::{self};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::Instant;

/// Folder of the starts within that of the results.
pub(super) const FOLDER: &str = "starts";

/// Folder of one start.
pub(super) fn folder_of(folder: &Path, start: usize) -> PathBuf {
    folder.join(FOLDER).join(format!("{start:02}"))
}

/// A starting point of a plan.
#[derive(Clone, Copy, Debug)]
pub(super) struct Start {
    /// Its number, from 1.
    pub(super) number: usize,
    /// Seed of a random guess; none for the guess of the problem itself.
    pub(super) seed: Option<u64>,
}

/// A start that runs.
pub(super) struct Running {
    pub(super) start: Start,
    pub(super) child: Child,
    pub(super) told: File,
    pub(super) began: Instant,
}

/// The solve of one start, as if it had been typed.
pub(super) fn command(
    request: &CommandInput,
    folder: &Path,
    start: Start,
    seconds: Option<f64>,
) -> CommandInput {
    let guess = |seed| format!("control.guess={{\"random\":{{\"seed\":{seed}}}}}");
    let mut of_start = CommandInput {
        output: Some(folder_of(folder, start.number)),
        max_seconds: seconds,
        progress: ProgressDisplay::Never,
        ..request.clone()
    };
    of_start.set.extend(start.seed.map(guess));
    let typed = words(&of_start);
    let typed = typed.iter().map(|word| word.to_string_lossy());
    let typed: Vec<_> = ["proboscis".into()].into_iter().chain(typed).collect();
    of_start.command = typed.join(" ");
    of_start
}

/// What one types for a solve.
fn words(request: &CommandInput) -> Vec<OsString> {
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
    words.push("--quiet".into());
    words
}

/// Starts the process of one start.
pub(super) fn launch(command: &CommandInput, start: Start) -> io::Result<Running> {
    let told = tempfile::tempfile()?;
    let child = Command::new(std::env::current_exe()?)
        .args(words(command))
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(told.try_clone()?)
        .spawn()?;
    Ok(Running {
        start,
        child,
        told,
        began: Instant::now(),
    })
}
