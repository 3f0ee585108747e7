//! Solves as tasks of a HyperQueue server, which hands them to its workers.
//!
//! The server keeps a job when the program that submitted it is gone. The next call finds the job by its name, collects what has
//! ended, waits for what runs, and submits only what is in no job. A task that the server begins once more, after a loss of its journal, finds
//! its own record and does nothing.
//!
//! What is kept of a job until all its ends are collected is its name, and the folder of each of its tasks.

use crate::app::batch::launch::{Batch, EndObserver, RunEnd, words};
use crate::app::error::CommandError;
use crate::app::kept::record::{make_folder, parsed};
use crate::app::request::CommandInput;
use crate::report::atomic;
use crate::report::atomic::WriteError;
use crate::report::quoting;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::collections::BTreeMap;
use std::ffi::{OsStr, OsString};
use std::io::ErrorKind;
use std::os::unix::process::CommandExt;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};
use std::{fs, path, process, thread};

/// Least time between two questions to the server.
const PATIENCE: Duration = Duration::from_millis(200);

/// Part of the time that may pass with questions.
const SHARE: u32 = 10;

/// Runs all of a batch.
pub(super) fn run_all(batch: &Batch<'_>, told: EndObserver<'_>) -> Result<(), CommandError> {
    let mut open: BTreeMap<usize, &CommandInput> = batch.runs.iter().enumerate().collect();
    if let Some(job) = Job::earlier(batch.folder)? {
        follow(batch, &job, &mut open, told)?;
        job.forget();
    }
    let commands: Vec<CommandInput> = open.values().filter_map(|run| batch.command(run)).collect();
    if !commands.is_empty() && commands.len() == open.len() {
        let job = Job::submit(batch.folder, &commands)?;
        follow(batch, &job, &mut open, told)?;
        job.forget();
    }
    for index in open.into_keys() {
        // Nothing begins any more.
        let _ = told(index, None);
    }
    Ok(())
}

/// Tells how the runs end that are tasks of a job, and strikes them off; those that were cancelled stay.
fn follow(
    batch: &Batch<'_>,
    job: &Job,
    open: &mut BTreeMap<usize, &CommandInput>,
    told: EndObserver<'_>,
) -> Result<(), CommandError> {
    let mut left = job.tasks_of(open);
    let mut is_cancelled = false;
    while !left.is_empty() {
        let asked = Instant::now();
        let mut is_over = !batch.may_go_on();
        for task in job.tasks()? {
            let Some(&index) = left.get(&task.id).filter(|_| task.has_ended()) else {
                continue;
            };
            left.remove(&task.id);
            let Some(end) = task.end(&job.files) else {
                continue;
            };
            open.remove(&index);
            is_over |= told(index, Some(end)).is_break();
        }
        if is_over && !is_cancelled {
            job.cancel()?;
            is_cancelled = true;
        }
        if !left.is_empty() {
            thread::sleep(PATIENCE.max(SHARE * asked.elapsed()));
        }
    }
    Ok(())
}

/// Folder within that of the results.
const FOLDER: &str = "hyperqueue";

/// A job that the server has.
#[derive(Debug)]
struct Job {
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
    fn earlier(folder: &Path) -> Result<Option<Self>, CommandError> {
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
    fn submit(folder: &Path, commands: &[CommandInput]) -> Result<Self, CommandError> {
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
    fn tasks_of(&self, open: &BTreeMap<usize, &CommandInput>) -> BTreeMap<usize, usize> {
        let folders = self.kept.folders.iter().enumerate();
        let tasks: BTreeMap<&Path, usize> = folders.map(|(i, path)| (path.as_path(), i)).collect();
        let of = |(&index, run): (&usize, &&CommandInput)| {
            Some((*tasks.get(&*whole(run).ok()?)?, index))
        };
        open.iter().filter_map(of).collect()
    }

    /// Returns the tasks as the server reports them.
    fn tasks(&self) -> Result<Vec<Task>, CommandError> {
        let mut answer = ask(&["task", "list", &self.id])?;
        let tasks = answer.get_mut(&self.id).map(Value::take);
        let tasks = tasks.and_then(|tasks| serde_json::from_value(tasks).ok());
        tasks.ok_or_else(|| CommandError::Engine(format!("no tasks of the job {}", self.id)))
    }

    /// Ends what runs and begins nothing more.
    fn cancel(&self) -> Result<(), CommandError> {
        successful(&["job", "cancel", &self.id]).map(drop)
    }

    /// Removes the record: all is collected.
    fn forget(self) {
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
    let words = [program.into_os_string()].into_iter().chain(words(command));
    let words = words.map(|word| word.into_string().ok().filter(|word| !word.contains('\n')));
    let refused = "paths that are no UTF-8, or with line breaks, cannot be handed to it";
    let words: Option<Vec<String>> = words.collect();
    let words = words.ok_or_else(|| CommandError::option("--engine hyperqueue", refused))?;
    Ok(quoting::command(words))
}

/// Task as the server reports it.
#[derive(Debug, Deserialize)]
struct Task {
    /// Its number in the job.
    id: usize,
    state: String,
    /// Reason why it failed.
    #[serde(default)]
    error: Option<String>,
}

impl Task {
    /// Returns true if it has ended for good.
    fn has_ended(&self) -> bool {
        !matches!(self.state.as_str(), "waiting" | "running")
    }

    /// Returns its end, with what it wrote to standard error in the folder of the files of its job; none where it was cancelled.
    fn end(&self, files: &Path) -> Option<RunEnd> {
        let words = fs::read_to_string(files.join(format!("{}.txt", self.id))).unwrap_or_default();
        let (status, words) = match (self.state.as_str(), self.exit_status()) {
            ("finished", _) => (Some(0), words),
            ("failed", Some(status)) => (Some(status), words),
            ("failed", None) => (None, self.error.clone().unwrap_or(words)),
            _ => return None,
        };
        Some(RunEnd {
            status,
            words,
            // The server does not tell them.
            seconds: 0.0,
        })
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
pub(super) fn check() -> Result<(), CommandError> {
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
fn ask(arguments: &[impl AsRef<OsStr>]) -> Result<Value, CommandError> {
    let output = successful(arguments)?;
    let answer = serde_json::from_slice(&output.stdout);
    answer.map_err(|_| CommandError::Engine(message(&output)))
}

/// Returns the output of a command that the server follows.
///
/// # Errors
/// The server refuses it, or there is none any more.
fn successful(arguments: &[impl AsRef<OsStr>]) -> Result<Output, CommandError> {
    let output = output(arguments).map_err(|cause| CommandError::Engine(cause.to_string()))?;
    match output.status.success() {
        true => Ok(output),
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
