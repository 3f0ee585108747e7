//! Several motions from file to folder: each in a folder of its own within that of the results, and what they have in common, once.

use crate::app::error::CommandError;
use crate::app::fields;
use crate::app::kept::overwrite_check::{make_folder, make_folder_of};
use crate::app::kept::partial_result::{EARLIER, STOPPED};
use crate::app::kept::{solution_file, unfinished};
use crate::app::progress::Reached;
use crate::app::request::{CommandInput, CommandOutput, PageWanted, counted};
use crate::app::solve::{Solved, add_notes};
use crate::app::solve_summary::{describe, outcome_word};
use crate::app::summary::{SoughtValue, Summary, Versions};
use crate::control::{Motions, PEAK_VOLTAGE};
use crate::files::{Loaded, lay_out};
use crate::math::significant;
use crate::report::atomic;
use crate::report::file_set::FileSet;
use crate::report::origin::Origin;
use crate::report::page::compared;
use crate::tasks::{MotionsResult, solve_motions};
use crate::workflow::Remarks;
use crate::workflow::accuracy::Accuracy;
use serde::Serialize;
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Solves for several motions and writes their folders, solved or not.
pub(super) fn motions(
    request: &CommandInput,
    loaded: &Loaded,
    motions: &Motions,
    began: Instant,
    observer: &mut dyn FnMut(Reached<'_>),
) -> Result<CommandOutput, CommandError> {
    let read = began.elapsed().as_secs_f64();
    let results = request.folder();
    let (result, folder) = unfinished::solve(
        request,
        read,
        observer,
        |_, models, found| {
            let mut each = motions.list.iter().zip(models).enumerate();
            each.try_for_each(|(number, (motion, model))| {
                let own = results.join(&motion.name);
                make_folder(&own)?;
                solution_file::replace(&own.join(solution_file::UNFINISHED), model, &found(number))
            })
        },
        |asked, observe| solve_motions(motions, asked, observe),
    )?;
    let mut each = Vec::new();
    for (motion, one) in motions.list.iter().zip(&result.list) {
        let own = CommandInput {
            output: Some(folder.join(&motion.name)),
            ..request.clone()
        };
        let folder = make_folder_of(&own)?;
        let solved = Solved {
            request: &own,
            loaded,
            system: &motion.system,
            control: &motion.control,
            feedback: None,
            result: one,
        };
        each.push(solved.write(&folder, read, began)?);
        unfinished::done(&folder);
    }
    let mut summary = MotionsSummary::new(request, motions, &result, &each);
    if let Some(stopped) = each.iter().find(|one| STOPPED.contains(&&*one.status)) {
        // Of the results of a motion not all was written.
        summary.status.clone_from(&stopped.status);
    }
    write(request, &mut summary, &folder, began)?;
    let mut output = command_output(motions, &result, &summary, &each, &folder);
    add_notes(&mut output, request, loaded, &summary.status);
    Ok(output)
}

/// Writes what the motions have in common: the page of all side by side, and the summary last.
fn write(
    request: &CommandInput,
    summary: &mut MotionsSummary,
    folder: &Path,
    began: Instant,
) -> Result<(), CommandError> {
    let mut files = FileSet::in_folder(folder);
    EARLIER.iter().for_each(|name| files.remove(name));
    fields::remove_from(0, &mut files);
    let pages = summary.motions.iter().map(|one| folder.join(&one.folder));
    let pages: Vec<PathBuf> = pages.collect();
    let are_written = pages
        .iter()
        .all(|folder| folder.join(SIDE_BY_SIDE).is_file());
    if request.page == PageWanted::Written && are_written {
        let own = summary.motions.iter();
        let own: Vec<String> = own
            .map(|one| format!("{}/{}", one.folder, SIDE_BY_SIDE))
            .collect();
        let page = side_by_side(&request.command, &pages, &own)?;
        files.add(SIDE_BY_SIDE, page.as_bytes())?;
    }
    summary.seconds.total = began.elapsed().as_secs_f64();
    files.add("summary.json", summary.text().as_bytes())?;
    Ok(files.finish()?)
}

/// The answer of the command.
fn command_output(
    motions: &Motions,
    result: &MotionsResult,
    summary: &MotionsSummary,
    each: &[Summary],
    folder: &Path,
) -> CommandOutput {
    let mut is_solved = result.verdict.is_solved && !STOPPED.contains(&&*summary.status);
    let mut word = outcome_word(result.verdict.is_solved, &summary.status);
    let mut notes: Vec<String> = summary.message.iter().cloned().collect();
    let of_motions = each.iter().zip(&result.list).map(|(summary, one)| {
        let violated = one.optimum.violated.iter().map(describe);
        violated
            .chain(summary.notes.lines())
            .collect::<Vec<String>>()
    });
    let of_motions: Vec<Vec<String>> = of_motions.collect();
    let mut times: BTreeMap<&String, usize> = BTreeMap::new();
    of_motions
        .iter()
        .flatten()
        .for_each(|note| *times.entry(note).or_default() += 1);
    let are_one = |note: &String| times[note] >= each.len();
    notes.extend(of_motions[0].iter().filter(|note| are_one(note)).cloned());
    for (motion, own) in motions.list.iter().zip(&of_motions) {
        let own = own.iter().filter(|note| !are_one(note));
        notes.extend(own.map(|note| format!("motion \"{}\": {note}", motion.name)));
    }
    notes.extend(summary.notes.lines());
    let constants = summary.parameters.iter();
    notes.extend(constants.map(|found| format!("{}: {}", found.name, found.text())));
    if let (true, Some(accuracy)) = (is_solved, &summary.accuracy) {
        notes.extend(accuracy.notes());
        (word, is_solved) = accuracy.outcome(&word);
    }
    let objective = significant(summary.objective, 8);
    CommandOutput {
        is_solved,
        result: format!(
            "{word}: objective {objective}, {}, {}, {:.2} s, {}",
            counted(motions.list.len(), "motion"),
            counted(summary.iterations, "iteration"),
            summary.seconds.total,
            folder.display()
        ),
        notes,
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

/// `summary.json` of several motions.
#[derive(Debug, Serialize)]
struct MotionsSummary {
    command: String,
    input: String,
    /// A word: `solved`, where each motion is, or that of the first that is not.
    status: String,
    /// Reasons why motions are not solved, in words.
    #[serde(skip_serializing_if = "Option::is_none")]
    message: Option<String>,
    /// Warnings and notes on all of them.
    #[serde(skip_serializing_if = "Remarks::is_empty")]
    notes: Remarks,
    /// The sum of their objectives, or the greatest one.
    objective: f64,
    objective_units: Vec<String>,
    iterations: usize,
    variables: usize,
    constraints: usize,
    jacobian_nonzeros: usize,
    hessian_nonzeros: usize,
    /// Greatest violation of an equation or limit of a motion.
    infeasibility: f64,
    /// Constants that were sought.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    parameters: Vec<SoughtValue>,
    /// Sources whose inputs are the same in all motions.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    shared_inputs: Vec<String>,
    /// Bound of the objective above its least value; absent without a solution.
    #[serde(skip_serializing_if = "Option::is_none")]
    gap: Option<f64>,
    /// Estimated errors, the greatest of all motions.
    #[serde(skip_serializing_if = "Option::is_none")]
    accuracy: Option<Accuracy>,
    /// The motions in their order, with the summaries of their folders.
    motions: Vec<MotionEntry>,
    seconds: TotalSeconds,
    versions: Versions,
}

/// A motion in the summary of all.
#[derive(Debug, Serialize)]
struct MotionEntry {
    name: String,
    /// Its folder, in that of the results.
    folder: String,
    status: String,
    /// Its part of the objective, or its objective beside the greatest one.
    objective: f64,
    /// The weight of its objective at the optimum, where the greatest one is minimised: 0 below it.
    #[serde(skip_serializing_if = "Option::is_none")]
    weight: Option<f64>,
    intervals: usize,
    /// Final time in s.
    duration: f64,
}

/// Wall time in s.
#[derive(Debug, Default, Serialize)]
struct TotalSeconds {
    /// Seconds from reading to the last file but the summary.
    total: f64,
}

impl MotionsSummary {
    /// Of a result whose motions have these summaries.
    fn new(
        request: &CommandInput,
        motions: &Motions,
        result: &MotionsResult,
        each: &[Summary],
    ) -> Self {
        let MotionsResult {
            list,
            whole,
            iterations,
            accuracy,
            verdict,
            remarks,
        } = result;
        let constants = list[0].optimum.motion.parameters.iter();
        let constants = constants.filter(|found| found.name != PEAK_VOLTAGE);
        let weight = |number: usize| whole.weights.as_ref().map(|all| all[number]);
        let entries = motions.list.iter().zip(list).zip(each).enumerate();
        let entries = entries.map(|(number, ((motion, result), summary))| {
            let found = &result.optimum.motion;
            MotionEntry {
                name: motion.name.clone(),
                folder: motion.name.clone(),
                status: summary.status.clone(),
                objective: result.optimum.solution.objective,
                weight: weight(number),
                intervals: found.intervals(),
                duration: found.times[found.intervals()] / 1e3,
            }
        });
        let mut units: Vec<String> = Vec::new();
        let of_motions = motions.list.iter();
        for unit in of_motions.flat_map(|one| one.control.objective_units(&one.system)) {
            if !units.contains(&unit) {
                units.push(unit);
            }
        }
        Self {
            command: request.command.clone(),
            input: request.input.display().to_string(),
            status: verdict.word.to_owned(),
            message: verdict.message.clone(),
            notes: remarks.clone(),
            objective: whole.objective,
            objective_units: units,
            iterations: *iterations,
            variables: whole.variables,
            constraints: whole.constraints,
            jacobian_nonzeros: whole.jacobian_nonzeros,
            hessian_nonzeros: whole.hessian_nonzeros,
            parameters: constants.map(SoughtValue::new).collect(),
            shared_inputs: motions.shared_inputs.clone(),
            infeasibility: list
                .iter()
                .fold(0.0, |worst, one| one.optimum.infeasibility.max(worst)),
            gap: Some(whole.gap).filter(|gap| verdict.is_solved && gap.is_finite()),
            accuracy: accuracy.clone(),
            motions: entries.collect(),
            seconds: TotalSeconds::default(),
            versions: Versions::default(),
        }
    }

    /// Its text.
    fn text(&self) -> String {
        lay_out(&serde_json::to_string(self).expect("numbers and names are JSON"))
    }
}
