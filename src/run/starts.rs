//! A control problem solved from several starting points, each in a process of its own.
//!
//! Ipopt with MUMPS takes one solve at a time in a process. Each start is an ordinary `solve` of the same problem with
//! another guess in a folder of its own, `starts/03`, and can be run again alone.

use std::collections::BTreeMap;
use std::fs::{self, File};
use std::io::{self, Read, Seek};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::thread;
use std::time::{Duration, Instant};

use serde::{Deserialize, Serialize};

use crate::control::problem::Task;
use crate::ipopt::interrupt;
use crate::report::atomic::{self, WriteError};
use crate::report::table::aligned;
use crate::run::error::RunError;
use crate::run::folder::make_folder;
use crate::run::memory;
use crate::run::optimise::resolve;
use crate::run::progress::Progress;
use crate::run::request::{Request, Told};
use crate::run::words::key;
use crate::scene::{lay_out, read_problem};

/// Most starting points of one command; the seed of a start is that of the command times this number and its own.
const MOST: usize = 1000;
/// Folder of the starts within that of the results.
const FOLDER: &str = "starts";
/// Time between two looks at the processes.
const PATIENCE: Duration = Duration::from_millis(10);
/// Time that processes have to end in good order after Ctrl-C.
const GRACE: Duration = Duration::from_secs(3);
/// Relative difference of the objectives of one optimum.
const SAME_OBJECTIVE: f64 = 1e-6;
/// Difference of the voltages of one optimum, relative to the largest: weakly bounded ones are known to 1e-4.
const SAME_VOLTAGE: f64 = 1e-3;

/// How one start ended.
#[derive(Clone, Debug, Serialize)]
struct Ended {
    /// Its number, from 1.
    start: usize,
    /// Seed of a random guess; none for the guess of the problem itself.
    seed: Option<u64>,
    /// The word of its summary; `not_started`, or `failed` where it left none.
    status: String,
    objective: Option<f64>,
    iterations: Option<usize>,
    /// Greatest violation of an equation or limit.
    infeasibility: Option<f64>,
    seconds: f64,
    /// Number of the optimum it found, from 1 for the best.
    optimum: Option<usize>,
    #[serde(skip)]
    is_solved: bool,
    #[serde(skip)]
    voltages: Vec<f64>,
    /// What else was said of it.
    #[serde(skip)]
    notes: Vec<String>,
}

/// The section `starts` of `summary.json`.
#[derive(Debug, Serialize)]
struct Section<'a> {
    command: &'a str,
    count: usize,
    solved: usize,
    distinct_optima: usize,
    /// The start whose files these are.
    best: Option<usize>,
    /// Wall time of all of them in s.
    seconds: f64,
    each: &'a [Ended],
}

/// What is read of the summary of a start.
#[derive(Deserialize)]
struct Summary {
    status: String,
    objective: Option<f64>,
    iterations: Option<usize>,
    infeasibility: Option<f64>,
    seconds: Seconds,
    #[serde(default)]
    notes: Vec<String>,
}

#[derive(Deserialize)]
struct Seconds {
    total: f64,
}

/// What is read of the solution of a start.
#[derive(Deserialize)]
struct Solution {
    voltages: BTreeMap<String, Vec<f64>>,
}

/// Solves a control problem from its own guess and from `starts − 1` random ones, as many at once as there are cores.
///
/// The files of the best solution go to the folder itself, beside `starts.csv`.
///
/// # Errors
/// The input is wrong, or the results cannot be written. A start that fails is no error as long as one succeeds.
pub fn solve_from_starts(request: &Request, starts: usize, seed: u64) -> Result<Told, RunError> {
    let began = Instant::now();
    if !(1..MOST).contains(&starts) {
        let reason = format!(
            "expected a number of starting points from 1 to {}",
            MOST - 1
        );
        return Err(RunError::Option {
            option: "--starts",
            reason,
        });
    }
    let loaded = read_problem(&request.input, &request.set)?;
    let Task::Control(control) = &loaded.task else {
        let task = key(&loaded.task);
        return Err(RunError::Option {
            option: "--starts",
            reason: format!(
                "{} asks to {task}: only \"control\" has starting points",
                request.input.display()
            ),
        });
    };
    memory::of_elements(&request.input, &loaded.system)?;
    resolve(&request.input, &loaded.system, control)?;
    let folder = request.folder();
    make_folder(&folder)?;
    remove_older(&folder.join(FOLDER));
    make_folder(&folder.join(FOLDER))?;

    let seed_of = |start: usize| seed.wrapping_mul(MOST as u64).wrapping_add(start as u64);
    let plan: Vec<_> = (1..=starts)
        .map(|start| (start, (start > 1).then(|| seed_of(start))))
        .collect();
    let mut ended = run_all(request, &folder, plan, began)?;
    let distinct = number_optima(&mut ended);
    write(request, &folder, &ended, distinct, began)
}

/// Folder of one start.
fn folder_of(folder: &Path, start: usize) -> PathBuf {
    folder.join(FOLDER).join(format!("{start:02}"))
}

/// Starts of an earlier command.
fn remove_older(folder: &Path) {
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        let name = entry.file_name();
        if name
            .to_string_lossy()
            .bytes()
            .all(|byte| byte.is_ascii_digit())
        {
            fs::remove_dir_all(entry.path()).ok();
        }
    }
}

/// A start on its way.
struct Running {
    start: usize,
    seed: Option<u64>,
    child: Child,
    told: File,
    began: Instant,
}

/// The starts on their way; none of them outlives this list.
struct All(Vec<Running>);

impl Drop for All {
    fn drop(&mut self) {
        for running in &mut self.0 {
            running.child.kill().ok();
            running.child.wait().ok();
        }
    }
}

/// Runs the starts of a plan and tells how each ended, in the order of their numbers.
fn run_all(
    request: &Request,
    folder: &Path,
    plan: Vec<(usize, Option<u64>)>,
    began: Instant,
) -> Result<Vec<Ended>, RunError> {
    let at_once = thread::available_parallelism().map_or(1, usize::from);
    let progress = Progress::of_starts(request.progress, plan.len());
    let mut waiting = plan.into_iter().peekable();
    let mut running = All(Vec::new());
    let mut ended: Vec<Ended> = Vec::new();
    let mut stop_at = None;
    loop {
        if interrupt::requested() && stop_at.is_none() {
            stop_at = Some(Instant::now() + GRACE);
        }
        let left = request
            .max_seconds
            .map(|limit| limit - began.elapsed().as_secs_f64());
        let may_start = stop_at.is_none() && left.is_none_or(|left| left > 0.0);
        while may_start && running.0.len() < at_once {
            let Some((start, seed)) = waiting.next() else {
                break;
            };
            let launched = launch(request, folder, start, seed, left);
            running.0.push(launched.map_err(|cause| WriteError {
                path: folder_of(folder, start),
                cause,
            })?);
        }
        if !may_start {
            for (start, seed) in waiting.by_ref() {
                ended.push(Ended::without_files(start, seed, "not_started", 0.0));
            }
        }
        if stop_at.is_some_and(|time| Instant::now() > time) {
            for running in &mut running.0 {
                running.child.kill().ok();
            }
        }
        let mut index = 0;
        while index < running.0.len() {
            match running.0[index].child.try_wait() {
                Ok(None) => index += 1,
                Ok(Some(status)) => {
                    let done = running.0.swap_remove(index);
                    ended.push(Ended::of(done, status, folder)?);
                    let solved = ended.iter().filter(|one| one.is_solved).count();
                    let best = best(&ended).and_then(|i| ended[i].objective);
                    progress.start(ended.len(), solved, best);
                }
                Err(cause) => {
                    let path = folder_of(folder, running.0[index].start);
                    return Err(WriteError { path, cause }.into());
                }
            }
        }
        if running.0.is_empty() && waiting.peek().is_none() {
            break;
        }
        thread::sleep(PATIENCE);
    }
    ended.sort_by_key(|one| one.start);
    Ok(ended)
}

/// Starts the process of one start.
fn launch(
    request: &Request,
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

impl Ended {
    /// A start that left no files.
    fn without_files(start: usize, seed: Option<u64>, status: &str, seconds: f64) -> Self {
        Self {
            start,
            seed,
            status: status.to_owned(),
            objective: None,
            iterations: None,
            infeasibility: None,
            seconds,
            optimum: None,
            is_solved: false,
            voltages: Vec::new(),
            notes: Vec::new(),
        }
    }

    /// Reads what a start left.
    ///
    /// # Errors
    /// It says that the input is wrong.
    fn of(mut done: Running, status: ExitStatus, folder: &Path) -> Result<Self, RunError> {
        let Running { start, seed, .. } = done;
        if status.code() == Some(2) {
            let mut told = String::new();
            done.told.rewind().ok();
            done.told.read_to_string(&mut told).ok();
            let told = told.trim_end();
            let message = told.strip_prefix("error: ").unwrap_or(told).to_owned();
            return Err(RunError::Start { start, message });
        }
        let path = folder_of(folder, start);
        let Some(summary) = parsed::<Summary>(&path.join("summary.json")) else {
            let seconds = done.began.elapsed().as_secs_f64();
            let word = if interrupt::requested() {
                "interrupted"
            } else {
                "failed"
            };
            return Ok(Self::without_files(start, seed, word, seconds));
        };
        let is_solved = status.success();
        let solution = match is_solved {
            true => parsed::<Solution>(&path.join("solution.json")),
            false => None,
        };
        let voltages = solution.map_or_else(Vec::new, |solution| {
            solution.voltages.into_values().flatten().collect()
        });
        Ok(Self {
            start,
            seed,
            status: summary.status,
            objective: summary.objective,
            iterations: summary.iterations,
            infeasibility: summary.infeasibility,
            seconds: summary.seconds.total,
            optimum: None,
            is_solved,
            voltages,
            notes: summary.notes,
        })
    }

    /// Whether two solutions are one optimum.
    fn is_same(&self, other: &Self) -> bool {
        let (Some(a), Some(b)) = (self.objective, other.objective) else {
            return false;
        };
        let close = |a: f64, b: f64, tolerance: f64| (a - b).abs() <= tolerance;
        let largest = self
            .voltages
            .iter()
            .fold(0.0, |most: f64, v| most.max(v.abs()));
        close(a, b, SAME_OBJECTIVE * a.abs().max(b.abs()))
            && self.voltages.len() == other.voltages.len()
            && self
                .voltages
                .iter()
                .zip(&other.voltages)
                .all(|(a, b)| close(*a, *b, SAME_VOLTAGE * largest))
    }
}

fn parsed<T: for<'de> Deserialize<'de>>(path: &Path) -> Option<T> {
    serde_json::from_str(&fs::read_to_string(path).ok()?).ok()
}

/// The solution of least objective; where there is none, the start that came closest.
fn best(ended: &[Ended]) -> Option<usize> {
    let rank = |one: &Ended| match (one.is_solved, one.objective, one.infeasibility) {
        (true, Some(objective), _) => (0, objective),
        (_, _, Some(infeasibility)) => (1, infeasibility),
        _ => (2, 0.0),
    };
    let compare = |a: &usize, b: &usize| {
        let (a, b) = (rank(&ended[*a]), rank(&ended[*b]));
        a.0.cmp(&b.0).then(a.1.total_cmp(&b.1))
    };
    let all = 0..ended.len();
    let best = all.min_by(compare)?;
    (rank(&ended[best]).0 < 2).then_some(best)
}

/// Numbers the distinct optima, the best first; how many there are.
fn number_optima(ended: &mut [Ended]) -> usize {
    let mut solved: Vec<usize> = (0..ended.len()).filter(|&i| ended[i].is_solved).collect();
    let objective = |i: usize| ended[i].objective.unwrap_or(f64::INFINITY);
    solved.sort_by(|&a, &b| objective(a).total_cmp(&objective(b)));
    let mut firsts: Vec<usize> = Vec::new();
    for i in solved {
        let known = firsts
            .iter()
            .position(|&first| ended[first].is_same(&ended[i]));
        let number = known.unwrap_or_else(|| {
            firsts.push(i);
            firsts.len() - 1
        });
        ended[i].optimum = Some(number + 1);
    }
    firsts.len()
}

/// Writes the files of the best start and the table of all, and tells of them.
fn write(
    request: &Request,
    folder: &Path,
    ended: &[Ended],
    distinct: usize,
    began: Instant,
) -> Result<Told, RunError> {
    let origin = request.origin(true);
    let csv = format!("# {}\n{}", origin.line(), csv(ended));
    atomic::write(&folder.join("starts.csv"), csv.as_bytes())?;
    // Of the starts that found the best optimum the first, whatever the last digits say.
    let first = ended.iter().find(|one| one.optimum == Some(1));
    let best = first.or_else(|| best(ended).map(|i| &ended[i]));
    let solved = ended.iter().filter(|one| one.is_solved).count();
    let seconds = began.elapsed().as_secs_f64();
    let section = Section {
        command: &request.command,
        count: ended.len(),
        solved,
        distinct_optima: distinct,
        best: best.map(|one| one.start),
        seconds,
        each: ended,
    };
    if let Some(best) = best {
        copy(&folder_of(folder, best.start), folder, &section)?;
    }
    let is_solved = solved > 0;
    let counts = format!(
        "{solved} of {} starts solved, {distinct} distinct {}, {seconds:.2} s, {}",
        ended.len(),
        if distinct == 1 { "optimum" } else { "optima" },
        folder.display()
    );
    let head = match best.and_then(|best| best.objective) {
        Some(objective) if is_solved => format!("solved: objective {objective:.7}, {counts}"),
        _ => format!("not solved: {counts}"),
    };
    let mut notes = best.map_or_else(Vec::new, |best| best.notes.clone());
    if interrupt::requested() {
        notes.push("interrupted; the files hold the best start that had ended".to_owned());
    }
    Ok(Told {
        is_solved,
        result: format!("{head}\n{}", aligned(&rows(ended))),
        notes,
    })
}

const COLUMNS: [&str; 7] = [
    "start",
    "guess",
    "status",
    "objective",
    "iterations",
    "seconds",
    "optimum",
];

/// The table as text for people.
fn rows(ended: &[Ended]) -> Vec<Vec<String>> {
    let or_dash = |text: Option<String>| text.unwrap_or_else(|| "-".to_owned());
    let row = |one: &Ended| {
        vec![
            one.start.to_string(),
            one.seed
                .map_or("own".to_owned(), |seed| format!("seed {seed}")),
            one.status.replace('_', " "),
            or_dash(one.objective.map(|value| format!("{value:.7}"))),
            or_dash(one.iterations.map(|count| count.to_string())),
            format!("{:.2}", one.seconds),
            or_dash(one.optimum.map(|number| number.to_string())),
        ]
    };
    let head = COLUMNS.map(str::to_owned).to_vec();
    [head].into_iter().chain(ended.iter().map(row)).collect()
}

/// The table as `starts.csv`; cells of what does not exist are empty.
fn csv(ended: &[Ended]) -> String {
    let mut text = "start,seed,status,objective,iterations,seconds [s],optimum\n".to_owned();
    for one in ended {
        let cells = [
            one.start.to_string(),
            one.seed.map_or_else(String::new, |seed| seed.to_string()),
            one.status.clone(),
            one.objective
                .map_or_else(String::new, |value| format!("{value:?}")),
            one.iterations
                .map_or_else(String::new, |count| count.to_string()),
            format!("{:?}", one.seconds),
            one.optimum
                .map_or_else(String::new, |number| number.to_string()),
        ];
        text.push_str(&cells.join(","));
        text.push('\n');
    }
    text
}

/// Copies the files of a start, its summary last and with the table of all.
fn copy(from: &Path, to: &Path, section: &Section<'_>) -> Result<(), WriteError> {
    let failed = |path: &Path| {
        let path = path.to_owned();
        move |cause| WriteError { path, cause }
    };
    let mut summary = None;
    for entry in fs::read_dir(from).map_err(failed(from))? {
        let path = entry.map_err(failed(from))?.path();
        let Some(name) = path.file_name() else {
            continue;
        };
        if path.is_dir() {
            make_folder(&to.join(name))?;
            for entry in fs::read_dir(&path).map_err(failed(&path))? {
                let file = entry.map_err(failed(&path))?;
                let bytes = fs::read(file.path()).map_err(failed(&file.path()))?;
                atomic::write(&to.join(name).join(file.file_name()), &bytes)?;
            }
        } else if name == "summary.json" {
            summary = Some(fs::read_to_string(&path).map_err(failed(&path))?);
        } else {
            let bytes = fs::read(&path).map_err(failed(&path))?;
            atomic::write(&to.join(name), &bytes)?;
        }
    }
    let summary = summary.unwrap_or_else(|| "{}".to_owned());
    atomic::write(
        &to.join("summary.json"),
        with_section(&summary, section).as_bytes(),
    )
}

/// A summary with the section of the starts at its end.
fn with_section(summary: &str, section: &Section<'_>) -> String {
    let compact = serde_json::to_string(section).expect("numbers and words are JSON");
    let laid_out = lay_out(&compact);
    let indented = laid_out.trim_end().replace('\n', "\n  ");
    let open = summary.trim_end().trim_end_matches('}').trim_end();
    let comma = if open.ends_with('{') { "" } else { "," };
    format!("{open}{comma}\n  \"starts\": {indented}\n}}\n")
}
