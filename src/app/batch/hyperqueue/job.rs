//! Record of a job until all its ends are collected: its name, and the folder of each of its tasks.

use crate::app::batch::launch::{RunEnd, Said, of_status, words};
use crate::app::error::CommandError;
use crate::app::kept::overwrite_check::make_folder;
use crate::app::kept::record::parsed;
use crate::app::request::CommandInput;
use crate::report::atomic;
use crate::report::atomic::WriteError;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::collections::BTreeMap;
use std::ffi::{OsStr, OsString};
use std::io::ErrorKind;
use std::os::unix::process::CommandExt;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::time::{SystemTime, UNIX_EPOCH};
use std::{fs, path, process};

/// Folder within that of the results.
const FOLDER: &str = "hyperqueue";

/// A job that the server has.
#[derive(Debug)]
pub(super) struct Job {
    /// Its number at the server.
    id: String,
    /// The folder of its files.
    files: PathBuf,
    kept: Kept,
}

#[derive(Debug, Serialize, Deserialize)]
struct Kept {
    /// No other job has it.
    name: String,
    /// Folder of the results of each task.
    folders: Vec<PathBuf>,
}

impl Job {
    /// The job that an earlier call submitted and of which not all is collected, if the server still has it.
    ///
    /// # Errors
    /// The server does not answer.
    pub(super) fn earlier(folder: &Path) -> Result<Option<Self>, CommandError> {
        let files = folder.join(FOLDER);
        let Some(kept) = parsed::<Kept>(&files.join("job.json")) else {
            return Ok(None);
        };
        let jobs = ask(&["job", "list", "--all"])?;
        let named = jobs.as_array().into_iter().flatten();
        let mut named = named.filter(|job| job["name"] == kept.name.as_str());
        let id = named.next().map(|job| job["id"].to_string());
        Ok(id.map(|id| Self { id, files, kept }))
    }

    /// Submits solves.
    ///
    /// # Errors
    /// A file cannot be written, or the server refuses the job.
    pub(super) fn submit(folder: &Path, commands: &[CommandInput]) -> Result<Self, CommandError> {
        let files = folder.join(FOLDER);
        make_folder(&files)?;
        let since = SystemTime::now().duration_since(UNIX_EPOCH);
        let since = since.unwrap_or_default().as_nanos();
        let kept = Kept {
            name: format!("proboscis-{}-{since}", process::id()),
            folders: commands.iter().map(whole).collect::<Result<_, _>>()?,
        };
        let lines: Vec<String> = commands.iter().map(line).collect::<Result<_, _>>()?;
        let tasks = files.join("tasks.txt");
        atomic::write(&tasks, (lines.join("\n") + "\n").as_bytes())?;
        let text = serde_json::to_string(&kept).expect("names are JSON");
        atomic::write(&files.join("job.json"), text.as_bytes())?;
        let mut arguments: Vec<OsString> = vec!["submit".into()];
        let mut option = |name: &str, value: OsString| arguments.extend([name.into(), value]);
        option("--name", kept.name.clone().into());
        option("--each-line", tasks.into());
        option("--cpus", "1".into());
        // Each solve then sees the one core that it has.
        option("--pin", "taskset".into());
        option("--stdout", "none".into());
        option("--stderr", files.join("%{TASK_ID}.txt").into());
        arguments.extend(["--", "sh", "-c", "eval \"exec $HQ_ENTRY\""].map(OsString::from));
        let answer = ask(&arguments)?;
        let id = answer["id"].to_string();
        Ok(Self { id, files, kept })
    }

    /// The tasks of runs that are still open, and the index of their run.
    pub(super) fn tasks_of(&self, open: &BTreeMap<usize, &CommandInput>) -> BTreeMap<usize, usize> {
        let folders = self.kept.folders.iter().enumerate();
        let tasks: BTreeMap<&Path, usize> = folders.map(|(i, path)| (path.as_path(), i)).collect();
        let of = |(&index, run): (&usize, &&CommandInput)| {
            Some((*tasks.get(&*whole(run).ok()?)?, index))
        };
        open.iter().filter_map(of).collect()
    }

    /// Returns the tasks as the server reports them.
    pub(super) fn tasks(&self) -> Result<Vec<Task>, CommandError> {
        let mut answer = ask(&["task", "list", &self.id])?;
        let tasks = answer.get_mut(&self.id).map(Value::take);
        let tasks = tasks.and_then(|tasks| serde_json::from_value(tasks).ok());
        tasks.ok_or_else(|| CommandError::Engine(format!("no tasks of the job {}", self.id)))
    }

    /// The file of the standard error of a task.
    pub(super) fn standard_error(&self, task: usize) -> PathBuf {
        self.files.join(format!("{task}.txt"))
    }

    /// Ends what runs and begins nothing more.
    pub(super) fn cancel(&self) -> Result<(), CommandError> {
        tell(&["job", "cancel", &self.id])
    }

    /// Removes the record: all is collected.
    pub(super) fn forget(self) {
        fs::remove_dir_all(&self.files).ok();
    }
}

/// The absolute folder of the results of a solve.
fn whole(command: &CommandInput) -> Result<PathBuf, CommandError> {
    let folder = command.folder();
    Ok(path::absolute(&folder).map_err(WriteError::at(folder))?)
}

/// A solve as one types it in a shell.
fn line(command: &CommandInput) -> Result<String, CommandError> {
    let program =
        std::env::current_exe().map_err(|cause| CommandError::Engine(cause.to_string()))?;
    let mut quoted = Vec::new();
    for word in [program.into_os_string()].into_iter().chain(words(command)) {
        let word = word.into_string().ok().filter(|word| !word.contains('\n'));
        let word = word.ok_or_else(|| {
            CommandError::option(
                "--engine hyperqueue",
                "paths that are no UTF-8, or with line breaks, cannot be handed to it",
            )
        })?;
        quoted.push(format!("'{}'", word.replace('\'', r"'\''")));
    }
    Ok(quoted.join(" "))
}

/// Task as the server reports it.
#[derive(Debug, Deserialize)]
pub(super) struct Task {
    /// Its number in the job.
    pub(super) id: usize,
    state: String,
    /// Reason why it failed.
    #[serde(default)]
    error: Option<String>,
}

impl Task {
    /// Returns true if it has ended for good.
    pub(super) fn has_ended(&self) -> bool {
        !matches!(self.state.as_str(), "waiting" | "running")
    }

    /// Returns its end, with what it wrote to standard error in the file `standard_error`; none where it was cancelled.
    pub(super) fn end(&self, standard_error: &Path) -> Option<RunEnd> {
        let words = fs::read_to_string(standard_error).unwrap_or_default();
        let said = match (self.state.as_str(), self.exit_status()) {
            ("finished", _) => Said::Solved,
            ("failed", Some(status)) => of_status(Some(status), &words),
            ("failed", None) => Said::Failed(self.error.clone().unwrap_or(words)),
            _ => return None,
        };
        // The server does not tell them.
        let seconds = 0.0;
        Some(RunEnd { said, seconds })
    }

    /// The exit status that is in the words of the server; none where a signal ended it, or its worker was lost.
    fn exit_status(&self) -> Option<i32> {
        let (_, after) = self.error.as_ref()?.split_once("exit code ")?;
        let end = after.find(|c: char| !c.is_ascii_digit());
        after[..end.unwrap_or(after.len())].parse().ok()
    }
}

/// The command.
const PROGRAM: &str = "hq";

/// Checks that there is a server that answers.
///
/// # Errors
/// There is none, or the command `hq` is not there.
pub(in crate::app::batch) fn check() -> Result<(), CommandError> {
    let refused = |reason: String| CommandError::option("--engine hyperqueue", reason);
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
