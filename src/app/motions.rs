//! Several motions in the folder of their results: what they have in common, beside the folder of each.

use crate::app::error::CommandError;
use crate::app::fields::FOLDER;
use crate::app::kept::overwrite_check::make_folder;
use crate::app::kept::partial_result::{EARLIER, STOPPED};
use crate::app::request::{CommandInput, CommandOutput, PageWanted, counted};
use crate::app::solve_summary::{describe, gap, outcome_word, parameter, parameter_note};
use crate::app::summary::{Summary, versions};
use crate::control::PEAK_VOLTAGE;
use crate::control::problem::ControlTask;
use crate::files::Entries;
use crate::math::significant;
use crate::model::FoundParameter;
use crate::report::atomic;
use crate::report::file_set::FileSet;
use crate::report::origin::Origin;
use crate::report::page::compared;
use crate::report::paraview::remove_from;
use crate::tasks::MotionsResult;
use std::fs;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// The part that all motions have in common, with their summaries in the order of the motions.
pub(super) struct Together<'a> {
    pub(super) request: &'a CommandInput,
    pub(super) task: &'a ControlTask<'a>,
    pub(super) result: &'a MotionsResult,
    pub(super) each: &'a [Summary],
    /// `solved`, where each motion is, or the word of the first that is not.
    pub(super) status: &'a str,
    pub(super) folder: &'a Path,
}

impl Together<'_> {
    /// Writes the page of all side by side, and the summary last; returns the answer of the command.
    pub(super) fn write(&self, began: Instant) -> Result<CommandOutput, CommandError> {
        let mut files = FileSet::in_folder(self.folder);
        EARLIER.iter().for_each(|name| files.remove(name));
        remove_from(0, FOLDER, &mut files);
        let names = || self.task.motions.iter().map(|motion| motion.name);
        let folders: Vec<PathBuf> = names().map(|name| self.folder.join(name)).collect();
        let is_written = |folder: &PathBuf| folder.join(SIDE_BY_SIDE).is_file();
        if self.request.page == PageWanted::Written && folders.iter().all(is_written) {
            let pages: Vec<String> = names()
                .map(|name| format!("{name}/{SIDE_BY_SIDE}"))
                .collect();
            let page = side_by_side(&self.request.command, &folders, &pages)?;
            files.add(SIDE_BY_SIDE, page.as_bytes())?;
        }
        let seconds = began.elapsed().as_secs_f64();
        files.add("summary.json", self.summary(seconds).laid_out().as_bytes())?;
        files.finish()?;
        Ok(self.command_output(seconds))
    }

    /// Constants that were sought.
    fn parameters(&self) -> impl Iterator<Item = &FoundParameter> {
        let all = self.result.list[0].optimum.motion.parameters.iter();
        all.filter(|found| found.name != PEAK_VOLTAGE)
    }

    /// `summary.json` of all; `seconds` are those from reading to the last file but this.
    fn summary(&self, seconds: f64) -> Entries {
        let MotionsResult {
            list,
            whole,
            accuracy,
            verdict,
            remarks,
            ..
        } = self.result;
        let mut units: Vec<String> = Vec::new();
        let each = self.task.motions.iter();
        for unit in each.flat_map(|one| one.control.objective_units(one.system)) {
            if !units.contains(&unit) {
                units.push(unit);
            }
        }
        let infeasibility = list.iter().map(|one| one.optimum.infeasibility);
        let motions = (0..list.len()).map(|number| self.motion(number));
        Entries::default()
            .with("command", &self.request.command)
            .with("input", self.request.input.display().to_string())
            .with("status", self.status)
            .with_some("message", verdict.message.as_ref())
            .with_some("notes", Some(remarks).filter(|remarks| !remarks.is_empty()))
            // The sum of the objectives, or the greatest one.
            .with("objective", whole.objective)
            .with("objective_units", units)
            .with("iterations", self.result.iterations)
            .with("variables", whole.variables)
            .with("constraints", whole.constraints)
            .with("jacobian_nonzeros", whole.jacobian_nonzeros)
            .with("hessian_nonzeros", whole.hessian_nonzeros)
            .with(
                "infeasibility",
                infeasibility.fold(0.0, |worst, one| one.max(worst)),
            )
            .with_any("parameters", self.parameters().map(parameter))
            .with_any("shared_inputs", self.task.shared_inputs)
            .with_some("gap", gap(whole.gap, verdict))
            // The greatest errors of all motions.
            .with_some("accuracy", accuracy.as_ref())
            .with_each("motions", motions)
            .with("seconds", Entries::default().with("total", seconds))
            .with("versions", versions())
    }

    /// A motion in the summary of all.
    fn motion(&self, number: usize) -> Entries {
        let name = self.task.motions[number].name;
        let optimum = &self.result.list[number].optimum;
        let intervals = optimum.motion.intervals();
        let weights = self.result.whole.weights.as_ref();
        Entries::default()
            .with("name", name)
            .with("folder", name)
            .with("status", &self.each[number].status)
            // Its part of the objective, or its objective beside the greatest one.
            .with("objective", optimum.solution.objective)
            // That of its objective at the optimum, where the greatest one is minimised: 0 below it.
            .with_some("weight", weights.map(|all| all[number]))
            .with("intervals", intervals)
            .with("duration", optimum.motion.times[intervals] / 1e3)
    }

    /// The answer of the command.
    fn command_output(&self, seconds: f64) -> CommandOutput {
        let MotionsResult {
            whole,
            accuracy,
            verdict,
            remarks,
            ..
        } = self.result;
        let mut is_solved = verdict.is_solved && !STOPPED.contains(&self.status);
        let mut word = outcome_word(verdict.is_solved, self.status);
        let mut notes: Vec<String> = verdict.message.iter().cloned().collect();
        notes.extend(self.notes_of_motions());
        notes.extend(remarks.lines());
        notes.extend(self.parameters().map(parameter_note));
        if let (true, Some(accuracy)) = (is_solved, accuracy) {
            notes.extend(accuracy.notes());
            (word, is_solved) = accuracy.outcome(&word);
        }
        CommandOutput {
            is_solved,
            result: format!(
                "{word}: objective {}, {}, {}, {seconds:.2} s, {}",
                significant(whole.objective, 8),
                counted(self.each.len(), "motion"),
                counted(self.result.iterations, "iteration"),
                self.folder.display()
            ),
            notes,
        }
    }

    /// Notes on the motions: those that all have once, then the others with the names of their motions.
    fn notes_of_motions(&self) -> Vec<String> {
        let results = self.each.iter().zip(&self.result.list);
        let lists = results.map(|(summary, one)| {
            let violated = one.optimum.violated.iter().map(describe);
            violated.chain(summary.notes.lines()).collect()
        });
        let lists: Vec<Vec<String>> = lists.collect();
        let times = |note| {
            lists
                .iter()
                .flatten()
                .filter(|other| *other == note)
                .count()
        };
        let (mut notes, mut others) = (Vec::new(), Vec::new());
        for (number, (motion, list)) in self.task.motions.iter().zip(&lists).enumerate() {
            for note in list {
                match times(note) >= lists.len() {
                    true if number == 0 => notes.push(note.clone()),
                    true => {}
                    false => others.push(format!("motion \"{}\": {note}", motion.name)),
                }
            }
        }
        notes.extend(others);
        notes
    }
}

/// Name of the page of a result.
const SIDE_BY_SIDE: &str = "report.html";

/// Writes `report.html` into `output`, which compares the results of some folders.
///
/// # Errors
/// A folder has no page of a result, or the page cannot be written.
pub fn compare(
    command: &str,
    folders: &[PathBuf],
    output: &Path,
) -> Result<CommandOutput, CommandError> {
    let page = side_by_side(command, folders, &[])?;
    // Its own page would be replaced by that of all.
    let place = |folder: &Path| fs::canonicalize(folder).ok();
    let is_own = |folder: &&PathBuf| place(folder).is_some_and(|it| place(output) == Some(it));
    if let Some(own) = folders.iter().find(is_own) {
        return Err(CommandError::option(
            "--output",
            format!(
                "found {}, one of the results, expected another folder: its report.html is that of a run",
                own.display()
            ),
        ));
    }
    make_folder(output)?;
    let file = output.join(SIDE_BY_SIDE);
    atomic::write(&file, page.as_bytes())?;
    Ok(CommandOutput {
        is_solved: true,
        result: file.display().to_string(),
        notes: Vec::new(),
    })
}

/// The page that compares the results of some folders, whose names lead to `pages` of their own.
///
/// # Errors
/// A folder has no page of a result.
fn side_by_side(
    command: &str,
    folders: &[PathBuf],
    pages: &[String],
) -> Result<String, CommandError> {
    let wrong = |reason| CommandError::option("RESULT", reason);
    let mut results = Vec::new();
    for (folder, name) in folders.iter().zip(names(folders)) {
        let file = folder.join(SIDE_BY_SIDE);
        let html = fs::read_to_string(&file).map_err(|cause| {
            wrong(format!(
                "cannot read {}: {cause}; a run writes it unless --no-report is given",
                file.display()
            ))
        })?;
        let data = compared::data(&html).ok_or_else(|| {
            wrong(format!(
                "{} is no whole page of a result of this version",
                file.display()
            ))
        })?;
        results.push((name, data));
    }
    let origin = Origin {
        command: command.to_owned(),
        version: Origin::program(),
        ..Origin::default()
    };
    Ok(compared::html(&results, pages, &origin))
}

/// The last parts of the paths where all differ, otherwise the whole paths.
fn names(folders: &[PathBuf]) -> Vec<String> {
    let last = |folder: &PathBuf| Some(folder.file_name()?.to_string_lossy().into_owned());
    let names: Option<Vec<String>> = folders.iter().map(last).collect();
    let differ = |all: &Vec<String>| (1..all.len()).all(|i| !all[..i].contains(&all[i]));
    let whole = || {
        folders
            .iter()
            .map(|folder| folder.display().to_string())
            .collect()
    };
    names.filter(differ).unwrap_or_else(whole)
}
