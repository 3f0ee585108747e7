//! A control problem solved from several starting points, in threads or in processes.
//!
//! Each start is an ordinary `solve` of the same problem with another guess in a folder of its own, `starts/03`, and can be run again
//! alone. Ipopt with MUMPS takes one solve at a time in a process, so that each start has a process of its own then. The files of the best start
//! and a table of all are the result.

use crate::app::batch::{Batch, Ended, RunIn, run_all, task_runs_at_once};
use crate::app::error::CommandError;
use crate::app::kept::record::{WrittenSummary, files_within, make_folder, make_folder_of, parsed};
use crate::app::request::{CommandInput, CommandOutput, key};
use crate::app::summary::keep_unanswered;
use crate::app::task::{read, refuse_replacing};
use crate::control::problem::MotionTask;
use crate::files::{Entries, Loaded, is_standard_input, printable};
use crate::math::significant;
use crate::report::atomic::{self, WriteError};
use crate::report::file_set::FileSet;
use crate::report::origin::Origin;
use crate::report::page::Variants;
use crate::report::table::{Cell, aligned, cells_csv, full_and_shown};
use crate::stop;
use crate::workflow::program::resolve_each;
use rank::Rank;
use serde::Deserialize;
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};
use std::time::Instant;

mod rank;

/// Most starting points of one command; the seed of a start is that of the command times this number and its own.
const MOST: usize = 1000;

/// Solves a control problem, of one motion or several, from its own guesses and from `starts − 1` random ones, as many at once as there are cores.
///
/// The files of the best solution go to the folder itself, next to `starts.csv` and their page `starts.html`. A `text` stands for that of the problem file, which then only names
/// it and the folder that paths are relative to; it is not solved in processes, which read the file.
///
/// # Errors
/// The input is wrong, or the results cannot be written. A start that fails is no error as long as one succeeds.
pub fn solve_from_starts(
    request: &CommandInput,
    text: Option<&str>,
    starts: usize,
    seed: u64,
    wanted: RunIn,
) -> Result<CommandOutput, CommandError> {
    let began = Instant::now();
    if !(1..MOST).contains(&starts) {
        let most = MOST - 1;
        return Err(wrong_option(format!(
            "expected a number of starting points from 1 to {most}"
        )));
    }
    let loaded = read(&request.input, text, &request.set)?;
    let places = check_problem(request, &loaded)?;
    let run_in = wanted.of_tasks(task_runs_at_once(&loaded));
    if run_in == RunIn::Processes && is_standard_input(&request.input) {
        return Err(wrong_option(
            "each process reads the problem anew, which standard input does not allow: give a file"
                .to_owned(),
        ));
    }
    let folder = make_folder_of(request)?;
    remove_older(&folder.join(FOLDER));
    make_folder(&folder.join(FOLDER))?;
    let seed_of = |number: usize| {
        let first = seed.wrapping_mul(MOST as u64);
        (number > 1).then(|| first.wrapping_add(number as u64))
    };
    // All guesses have one seed, so that inputs which motions share begin alike.
    let guess = |place, seed| format!("{place}={{\"random\":{{\"seed\":{seed}}}}}");
    let run = |number| {
        let guesses = places.iter();
        let guesses = guesses.filter_map(|place| Some(guess(place, seed_of(number)?)));
        CommandInput {
            set: request.set.iter().cloned().chain(guesses).collect(),
            output: Some(folder_of(&folder, number)),
            ..request.clone()
        }
    };
    let runs: Vec<CommandInput> = (1..=starts).map(run).collect();
    let batch = Batch {
        runs: &runs,
        text,
        run_in,
        folder: &folder,
        max_seconds: request.max_seconds,
        began,
    };
    let mut ended: Vec<StartEnd> = Vec::new();
    run_all(&batch, "start", request.progress, &mut |index, one| {
        let number = index + 1;
        ended.push(StartEnd::new(number, seed_of(number), one, &folder)?);
        Ok(best(&ended).and_then(StartEnd::objective))
    })?;
    ended.sort_by_key(|one| one.number);
    let distinct = number_optima(&mut ended);
    let name = &loaded.system.name;
    write(request, &batch, &ended, distinct, name)
}

fn wrong_option(reason: String) -> CommandError {
    CommandError::option("--starts", reason)
}

/// Checks that a problem has starting points, and that its starts and goals exist; returns the places of its guesses.
fn check_problem(request: &CommandInput, loaded: &Loaded) -> Result<Vec<String>, CommandError> {
    refuse_replacing(request, loaded)?;
    let Some(task) = loaded.task.motions(&loaded.system) else {
        return Err(wrong_option(format!(
            "{} asks to {}: only \"control\" has starting points",
            request.input.display(),
            key(&loaded.task)
        )));
    };
    let ends = resolve_each(&task).map_err(CommandError::in_file(&request.input));
    keep_unanswered(request, ends)?;
    let place = |(number, motion): (usize, &MotionTask<'_>)| match motion.is_alone() {
        true => "control.guess".to_owned(),
        false => format!("control.{}[{number}].guess", motion.control.list()),
    };
    Ok(task.motions.iter().enumerate().map(place).collect())
}

/// Starts of an earlier command.
fn remove_older(folder: &Path) {
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        let name = entry.file_name();
        let name = name.to_string_lossy();
        if name.bytes().all(|byte| byte.is_ascii_digit()) {
            fs::remove_dir_all(entry.path()).ok();
        }
    }
}

/// Writes the files of the best start and the table of all, and returns a message.
fn write(
    request: &CommandInput,
    batch: &Batch<'_>,
    ended: &[StartEnd],
    distinct: usize,
    name: &str,
) -> Result<CommandOutput, CommandError> {
    let folder = &*request.folder();
    let origin = request.origin(true);
    let (full, shown) = full_and_shown(table(ended));
    let csv = cells_csv(&full, &origin);
    atomic::write(&folder.join("starts.csv"), csv.as_bytes())?;
    let page = page(name, ended, &shown, &origin);
    atomic::write(&folder.join("starts.html"), page.as_bytes())?;
    // Of the starts that found the best optimum the first, whatever the last digits say.
    let first = ended.iter().find(|one| one.optimum == Some(1));
    let best = first.or_else(|| best(ended));
    let solved = ended.iter().filter(|one| one.ended.is_solved).count();
    let seconds = batch.began.elapsed().as_secs_f64();
    let section = Entries::default()
        .with("command", &request.command)
        .with("run_in", batch.run_in)
        .with("count", ended.len())
        .with("solved", solved)
        .with("distinct_optima", distinct)
        // The start whose files these are.
        .with("best", best.map(|one| one.number))
        // Wall time of all of them.
        .with("seconds", seconds)
        .with_each("each", ended.iter().map(StartEnd::entries));
    if let Some(best) = best {
        copy(&folder_of(folder, best.number), folder, &section)?;
    }
    let is_stopped = stop::requested();
    let counts = format!(
        "{solved} of {} starts solved, {distinct} distinct {}, {seconds:.2} s, {}",
        ended.len(),
        if distinct == 1 { "optimum" } else { "optima" },
        folder.display()
    );
    let head = match best.and_then(StartEnd::objective) {
        Some(objective) if solved > 0 => {
            let word = if is_stopped {
                "interrupted: best"
            } else {
                "solved:"
            };
            let objective = significant(objective, 8);
            format!("{word} objective {objective}, {counts}")
        }
        _ => format!("not solved: {counts}"),
    };
    let mut notes = best.map_or_else(Vec::new, |best| best.notes.clone());
    notes.extend(best.and_then(|best| lower(best, ended)));
    for one in ended {
        let told = one.ended.message.as_deref().map(printable);
        let number = one.number;
        notes.extend(told.map(|message| format!("start {number} failed: {message}")));
    }
    if is_stopped {
        notes.push("interrupted; the files hold the best start that had ended".to_owned());
    }
    Ok(CommandOutput {
        is_solved: solved > 0 && !is_stopped,
        result: format!("{head}\n{}", aligned(&shown)),
        notes,
    })
}

/// A note where a start whose goal is not held has a lower objective than the best one.
fn lower(best: &StartEnd, ended: &[StartEnd]) -> Option<String> {
    let objective = best.objective().filter(|_| best.ended.is_solved)?;
    let others = ended
        .iter()
        .filter(|one| one.ended.is_solved && !one.is_held);
    let mut lower = others.filter_map(|one| Some((one.number, one.objective()?)));
    let (start, other) = lower.find(|(_, other)| best.is_held && *other < objective)?;
    Some(format!(
        "note: start {start} has the lower objective {}, but does not keep its goal or period",
        significant(other, 8)
    ))
}

/// The table of all starts; cells of `starts.csv` without a value are empty.
fn table(ended: &[StartEnd]) -> Vec<Vec<Cell>> {
    let header = vec![
        Cell::same("start"),
        Cell::new("seed", "guess"),
        Cell::same("status"),
        Cell::same("objective"),
        Cell::same("iterations"),
        Cell::new("seconds [s]", "seconds"),
        Cell::same("optimum"),
    ];
    let none = || Cell::new("", "-");
    let row = |one: &StartEnd| {
        let summary = &one.ended.summary;
        let guess = |seed| Cell::new(seed, format!("seed {seed}"));
        let objective = |value| Cell::new(format!("{value:?}"), significant(value, 8));
        let seconds = summary.seconds.total;
        vec![
            Cell::same(one.number),
            one.seed.map_or_else(|| Cell::new("", "own"), guess),
            Cell::new(&summary.status, summary.status.replace('_', " ")),
            summary.objective.map_or_else(none, objective),
            summary.iterations.map_or_else(none, Cell::same),
            Cell::new(format!("{seconds:?}"), format!("{seconds:.2}")),
            one.optimum.map_or_else(none, Cell::same),
        ]
    };
    [header].into_iter().chain(ended.iter().map(row)).collect()
}

/// The page of all starts with their table.
fn page(name: &str, ended: &[StartEnd], table: &[Vec<String>], origin: &Origin) -> String {
    let page = |one: &StartEnd| folder_of(Path::new(""), one.number).join("report.html");
    let pages = ended.iter().map(|one| {
        let page = page(one).display().to_string();
        one.ended.is_solved.then_some(page)
    });
    let variants = Variants {
        kind: "Starts",
        title: name,
        of: "starts".to_owned(),
        varied: 1..2,
        table,
        pages: pages.collect(),
    };
    variants.html(origin)
}

/// Copies the files of a start, its summary last and with the table of all.
fn copy(from: &Path, to: &Path, section: &Entries) -> Result<(), WriteError> {
    let names = files_within(from).map_err(WriteError::at(from))?;
    let folders: BTreeSet<_> = names.iter().filter_map(|name| name.parent()).collect();
    for folder in folders {
        make_folder(&to.join(folder))?;
    }
    let mut files = FileSet::in_folder(to);
    let mut summary = "{}".to_owned();
    for name in &names {
        let path = from.join(name);
        match name == Path::new("summary.json") {
            true => summary = fs::read_to_string(&path).map_err(WriteError::at(path))?,
            false => files.add(name, &fs::read(&path).map_err(WriteError::at(path))?)?,
        }
    }
    files.add("summary.json", with_section(&summary, section).as_bytes())?;
    files.finish()
}

/// A summary with the section of the starts at its end.
fn with_section(summary: &str, section: &Entries) -> String {
    let laid_out = section.laid_out();
    let indented = laid_out.trim_end().replace('\n', "\n  ");
    let open = summary.trim_end().trim_end_matches('}').trim_end();
    let comma = if open.ends_with('{') { "" } else { "," };
    format!("{open}{comma}\n  \"starts\": {indented}\n}}\n")
}

/// Relative difference of the objectives of one optimum.
const SAME_OBJECTIVE: f64 = 1e-6;

/// Difference of the voltages of one optimum, relative to the largest: weakly bounded ones are known to 1e-4.
const SAME_VOLTAGE: f64 = 1e-3;

/// Warnings about an optimum whose goal is not held, or whose period does not come back.
const LEAVES: [&str; 2] = ["goal_not_held", "not_periodic"];

/// Folder of the starts within that of the results.
const FOLDER: &str = "starts";

/// Folder of one start.
fn folder_of(folder: &Path, start: usize) -> PathBuf {
    folder.join(FOLDER).join(format!("{start:02}"))
}

/// End of one start.
#[derive(Debug)]
struct StartEnd {
    /// Its number, from 1.
    number: usize,
    /// Seed of a random guess; none for the guess of the problem itself.
    seed: Option<u64>,
    ended: Ended,
    /// Number of the optimum it found, from 1 for the best.
    optimum: Option<usize>,
    /// True if nothing warns that it leaves its goal afterwards, or does not come back to its period.
    is_held: bool,
    voltages: Vec<f64>,
    /// Notes on it and its motions.
    notes: Vec<String>,
}

/// Entries that are read of the solution of a start.
#[derive(Deserialize)]
struct SolutionRecord {
    voltages: BTreeMap<String, Vec<f64>>,
}

impl StartEnd {
    /// Reads what a start left in its folder: its summary, and voltages and notes of the motions beside it.
    ///
    /// # Errors
    /// It says that the input is wrong.
    fn new(
        number: usize,
        seed: Option<u64>,
        ended: Ended,
        folder: &Path,
    ) -> Result<Self, CommandError> {
        let summary = &ended.summary;
        if summary.status == "refused" {
            return Err(CommandError::Start {
                start: number,
                message: ended.message.unwrap_or_default(),
            });
        }
        let path = folder_of(folder, number);
        let own = summary.motions.iter().map(|one| path.join(&one.folder));
        let mut folders: Vec<PathBuf> = own.collect();
        let mut remarks = vec![(None, summary.notes.clone())];
        for (motion, own) in summary.motions.iter().zip(&folders) {
            let own = WrittenSummary::of_folder(own);
            remarks.extend(own.map(|own| (Some(&motion.name), own.notes)));
        }
        if folders.is_empty() {
            folders.push(path);
        }
        let solutions = folders.iter().filter(|_| ended.is_solved);
        let solutions =
            solutions.filter_map(|own| parsed::<SolutionRecord>(&own.join("solution.json")));
        let voltages = solutions.flat_map(|one| one.voltages.into_values().flatten());
        let mut all = remarks.iter().flat_map(|(_, own)| &own.0);
        let notes = remarks.iter().flat_map(|(motion, own)| {
            let name = motion.map_or_else(String::new, |name| format!("motion \"{name}\": "));
            let lines = own.lines();
            lines.map(move |line| format!("{name}{line}"))
        });
        Ok(Self {
            optimum: None,
            is_held: !all.any(|one| LEAVES.contains(&&*one.code)),
            voltages: voltages.collect(),
            notes: notes.collect(),
            number,
            seed,
            ended,
        })
    }

    /// Objective of its point, where there is one.
    fn objective(&self) -> Option<f64> {
        self.ended.summary.objective
    }

    /// Its part of the summary.
    fn entries(&self) -> Entries {
        let summary = &self.ended.summary;
        Entries::default()
            .with("start", self.number)
            .with("seed", self.seed)
            .with("status", &summary.status)
            .with_some("message", self.ended.message.as_ref())
            .with("objective", summary.objective)
            .with("iterations", summary.iterations)
            // Greatest violation of an equation or limit.
            .with("infeasibility", summary.infeasibility)
            .with("seconds", summary.seconds.total)
            .with("optimum", self.optimum)
    }

    fn rank(&self) -> Rank {
        match self.objective() {
            Some(objective) if self.ended.is_solved => Rank::of_optimum(objective, self.is_held),
            _ => Rank::of_end(self.ended.summary.infeasibility),
        }
    }

    /// Returns true if two solutions are one optimum.
    fn is_same(&self, other: &Self) -> bool {
        let (Some(a), Some(b)) = (self.objective(), other.objective()) else {
            return false;
        };
        let close = |a: f64, b: f64, tolerance: f64| (a - b).abs() <= tolerance;
        let largest = self.voltages.iter();
        let largest = largest.fold(0.0, |most: f64, v| most.max(v.abs()));
        let mut pairs = self.voltages.iter().zip(&other.voltages);
        close(a, b, SAME_OBJECTIVE * a.abs().max(b.abs()))
            && self.voltages.len() == other.voltages.len()
            && pairs.all(|(a, b)| close(*a, *b, SAME_VOLTAGE * largest))
    }
}

/// The best start: see [`Rank`]; none where no start left a point.
fn best(ended: &[StartEnd]) -> Option<&StartEnd> {
    let best = ended.iter().min_by(|a, b| a.rank().compare(&b.rank()));
    best.filter(|best| best.rank().has_point())
}

/// Numbers the distinct optima, the best first; returns their number.
fn number_optima(ended: &mut [StartEnd]) -> usize {
    let each = ended.iter_mut().filter(|one| one.ended.is_solved);
    let mut solved: Vec<&mut StartEnd> = each.collect();
    solved.sort_by(|a, b| a.rank().compare(&b.rank()));
    let mut firsts: Vec<&StartEnd> = Vec::new();
    for one in solved {
        let known = firsts.iter().position(|first| first.is_same(one));
        one.optimum = Some(known.unwrap_or(firsts.len()) + 1);
        firsts.extend(known.is_none().then_some(&*one));
    }
    firsts.len()
}
