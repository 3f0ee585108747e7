//! The process of one start.

use crate::app::request::CommandInput;
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

/// A start that runs.
pub(super) struct Running {
    pub(super) start: usize,
    pub(super) seed: Option<u64>,
    pub(super) child: Child,
    pub(super) told: File,
    pub(super) began: Instant,
}

/// Starts the process of one start.
pub(super) fn launch(
    request: &CommandInput,
    folder: &Path,
    start: usize,
    seed: Option<u64>,
    seconds: Option<f64>,
) -> io::Result<Running> {
    let told = tempfile::tempfile()?;
    let mut command = Command::new(std::env::current_exe()?);
    command.arg("solve").arg(&request.input);
    for change in &request.set {
        command.arg("--set").arg(change);
    }
    if let Some(seed) = seed {
        command.arg("--set");
        command.arg(format!("control.guess={{\"random\":{{\"seed\":{seed}}}}}"));
    }
    command.arg("-o").arg(folder_of(folder, start));
    if let Some(iterations) = request.max_iterations {
        command.arg("--max-iterations").arg(iterations.to_string());
    }
    if let Some(seconds) = seconds {
        command.arg("--max-seconds").arg(seconds.to_string());
    }
    let child = command
        .arg("--quiet")
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(told.try_clone()?)
        .spawn()?;
    Ok(Running {
        start,
        seed,
        child,
        told,
        began: Instant::now(),
    })
}
