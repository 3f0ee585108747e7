//! The command `hq`, which sends requests to a server of HyperQueue.

use std::ffi::OsStr;
use std::io::ErrorKind;
use std::os::unix::process::CommandExt;
use std::process::{Command, Output, Stdio};

use serde_json::Value;

use crate::app::error::CommandError;

/// The command.
const PROGRAM: &str = "hq";

/// Checks that there is a server that answers.
///
/// # Errors
/// There is none, or the command `hq` is not there.
pub(in crate::app::batch) fn check() -> Result<(), CommandError> {
    let refused = |reason: String| CommandError::Option {
        option: "--engine hyperqueue",
        reason,
    };
    match output(&["job", "list"]) {
        Ok(output) if output.status.success() => Ok(()),
        Ok(output) => {
            let why = message(&output);
            Err(refused(format!(
                "no server of HyperQueue answers ({why}); \"hq server start\" starts one, and HQ_SERVER_DIR names its folder"
            )))
        }
        Err(cause) if cause.kind() == ErrorKind::NotFound => Err(refused(format!(
            "expected the command {PROGRAM:?} of HyperQueue on the PATH, found none"
        ))),
        Err(cause) => Err(refused(format!("cannot run {PROGRAM:?}: {cause}"))),
    }
}

/// Returns the answer of the server.
///
/// # Errors
/// It does not, or not in JSON.
pub(super) fn ask(arguments: &[impl AsRef<OsStr>]) -> Result<Value, CommandError> {
    let output = output(arguments).map_err(|cause| CommandError::Engine(cause.to_string()))?;
    let answer = serde_json::from_slice(&output.stdout).ok();
    answer
        .filter(|_| output.status.success())
        .ok_or_else(|| CommandError::Engine(message(&output)))
}

/// Asks for what has no answer.
///
/// # Errors
/// The server refuses it, or there is none any more.
pub(super) fn tell(arguments: &[impl AsRef<OsStr>]) -> Result<(), CommandError> {
    let output = output(arguments).map_err(|cause| CommandError::Engine(cause.to_string()))?;
    match output.status.success() {
        true => Ok(()),
        false => Err(CommandError::Engine(message(&output))),
    }
}

fn output(arguments: &[impl AsRef<OsStr>]) -> std::io::Result<Output> {
    Command::new(PROGRAM)
        .args(["--output-mode", "json"])
        .args(arguments)
        .stdin(Stdio::null())
        // Ctrl-C is for the program that asks.
        .process_group(0)
        .output()
}

/// Returns its message after a failure, without a trace of its calls.
fn message(output: &Output) -> String {
    let told = [&output.stdout, &output.stderr].map(|bytes| String::from_utf8_lossy(bytes));
    let error = told.iter().find_map(|text| {
        let parsed: Value = serde_json::from_str(text).ok()?;
        Some(parsed.get("error")?.as_str()?.to_owned())
    });
    let text = error.unwrap_or_else(|| told.concat());
    let text = text.split("Stack backtrace").next().unwrap_or_default();
    let words: Vec<&str> = text.split_whitespace().collect();
    words.join(" ")
}
