//! Record of a job until all its ends are collected: its name, and the folder of each of its tasks.

use std::collections::BTreeMap;
use std::ffi::OsString;
use std::fs;
use std::path::{self, Path, PathBuf};
use std::process;
use std::time::{SystemTime, UNIX_EPOCH};

use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::client::{ask, tell};
use super::task::Task;
use crate::app::batch::launch::words;
use crate::app::error::CommandError;
use crate::app::folder::make_folder;
use crate::app::request::CommandInput;
use crate::report::atomic::{self, WriteError};

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
        let text = fs::read_to_string(files.join("job.json")).unwrap_or_default();
        let Ok(kept) = serde_json::from_str::<Kept>(&text) else {
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
    path::absolute(&folder).map_err(|cause| {
        WriteError {
            path: folder,
            cause,
        }
        .into()
    })
}

/// A solve as one types it in a shell.
fn line(command: &CommandInput) -> Result<String, CommandError> {
    let program =
        std::env::current_exe().map_err(|cause| CommandError::Engine(cause.to_string()))?;
    let mut quoted = Vec::new();
    // A server that is started again from its journal may hand out a task once more that has ended.
    let words = words(command).into_iter().chain(["--once".into()]);
    for word in [program.into_os_string()].into_iter().chain(words) {
        let word = word.into_string().ok().filter(|word| !word.contains('\n'));
        let word = word.ok_or_else(|| CommandError::Option {
            option: "--engine hyperqueue",
            reason: "paths that are no UTF-8, or with line breaks, cannot be handed to it"
                .to_owned(),
        })?;
        quoted.push(format!("'{}'", word.replace('\'', r"'\''")));
    }
    Ok(quoted.join(" "))
}
