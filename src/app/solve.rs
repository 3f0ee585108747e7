//! A control problem from file to folder: solved, re-simulated, and reported; of several motions what they have in common, beside the folder of each.

use crate::app::blocks;
use crate::app::displayed_motion::{DisplayedMotion, Motion};
use crate::app::error::CommandError;
use crate::app::kept::record::{folder_within, make_folder, make_folder_of};
use crate::app::kept::{resume_file, solution_file, unfinished};
use crate::app::progress::Reached;
use crate::app::request::{CommandInput, CommandOutput, PageWanted, counted};
use crate::app::solve_summary::{
    asked_places, command_output, convergence, describe, gap, goal, outcome_word, parameter,
    parameter_note, program, rows, seconds, sensitivity_entries, tolerance_warning,
};
use crate::app::summary::{
    MEASURED, STOPPED, Summary, leave_out, remove_earlier, time_to_write, versions,
};
use crate::app::{feedback_files, fields};
use crate::control::PEAK_VOLTAGE;
use crate::control::problem::{Control, ControlTask};
use crate::dynamics::observations;
use crate::dynamics::trajectory::Trajectory;
use crate::files::{Entries, Loaded};
use crate::math::significant;
use crate::model::{FoundParameter, System};
use crate::report::atomic::WriteError;
use crate::report::file_set::FileSet;
use crate::report::lines::LinePlot;
use crate::report::origin::Origin;
use crate::report::page::compared;
use crate::report::{PageContent, Run, atomic, sensitivities, write_run};
use crate::stop;
use crate::tasks::{MotionsResult, SolveResult};
use crate::workflow::effects::Plan;
use crate::workflow::optimum::Optimum;
use crate::workflow::resimulate::constant;
use std::fs;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Length of the motion under constant voltages that is drawn next to the optimal one, in durations.
const COMPARED: usize = 3;
/// Statuses of a solve that might have gone on.
const MIGHT_GO_ON: [&str; 3] = ["interrupted", "time_limit", "iteration_limit"];

/// Solves a control problem and writes its folder, solved or not; of several motions each has a folder of its own within it.
pub(super) fn control(
    request: &CommandInput,
    loaded: &Loaded,
    began: Instant,
    observer: &mut dyn FnMut(Reached<'_>),
) -> Result<CommandOutput, CommandError> {
    let read = began.elapsed().as_secs_f64();
    let task = loaded.task.motions(&loaded.system);
    let task = task.expect("a problem of control has motions");
    let (result, folder) = unfinished::solve(request, &task, read, observer)?;
    let mut each = Vec::new();
    for (motion, one) in task.motions.iter().zip(&result.list) {
        let own = folder_within(&folder, motion.name);
        let own = CommandInput {
            output: Some(own),
            ..request.clone()
        };
        if !motion.is_alone() {
            make_folder_of(&own)?;
        }
        let solved = Solved {
            request: &own,
            loaded,
            system: motion.system,
            control: motion.control,
            result: one,
        };
        each.push(solved.write(read, began)?);
        unfinished::done(&own.folder());
    }
    let stopped = each.iter().find(|one| STOPPED.contains(&&*one.status));
    // Of the results of a motion not all was written.
    let status = stopped.map_or(result.verdict.word, |one| one.status.as_str());
    let mut output = match (&task.motions[..], &each[..]) {
        ([motion], [summary]) if motion.is_alone() => {
            command_output(summary, motion.control, &result.list[0], &folder)
        }
        _ => {
            let together = Together {
                request,
                task: &task,
                result: &result,
                each: &each,
                status,
                folder: &folder,
            };
            together.write(began)?
        }
    };
    output.notes.extend(loaded.note_lines());
    if MIGHT_GO_ON.contains(&status) {
        let command = resume_file::command(request, &loaded.task);
        output.notes.extend(command);
    }
    Ok(output)
}

/// A motion of a problem, solved or not.
struct Solved<'a> {
    request: &'a CommandInput,
    loaded: &'a Loaded,
    system: &'a System,
    control: &'a Control,
    result: &'a SolveResult,
}

impl Solved<'_> {
    /// Writes the files of a result to its folder, which exists, and its summary; `read` are the seconds before the solve.
    fn write(&self, read: f64, began: Instant) -> Result<Summary, CommandError> {
        let (control, result) = (self.control, self.result);
        let SolveResult {
            optimum, verdict, ..
        } = result;
        let mut summary =
            Summary::new(self.request, verdict.word, optimum.model.coordinates.name());
        summary.message.clone_from(&verdict.message);
        summary.task = program(self.system, control, result);
        summary.accuracy.clone_from(&result.accuracy);
        let model = optimum.sought.as_ref().unwrap_or(&optimum.model);
        summary.plan = Plan::from_model(model, Some(control), MEASURED);
        summary.seconds = seconds(optimum, read, began);
        add_observed(&mut summary, result);
        let writing = Instant::now();
        let mut files = FileSet::in_folder(&self.request.folder());
        solution_file::add(&mut files, &optimum.model, &optimum.motion)?;
        let (limit, kept) = (time_to_write(self.request, began), files.count());
        files.limit(&limit);
        let watch = stop::watch_by(limit.clone());
        if let Err(error) = self.write_files(&mut summary, &mut files) {
            let status = limit.reached().ok_or(error)?;
            leave_out(&mut summary, status, &mut files, kept);
        }
        drop(watch);
        summary.seconds.wrote(began, writing);
        summary.write(files)?;
        Ok(summary)
    }

    /// Writes the fields of the motion, tables, figures and page, and adds what they hold to the summary.
    fn write_files(&self, summary: &mut Summary, files: &mut FileSet) -> Result<(), WriteError> {
        let result = self.result;
        let SolveResult {
            optimum,
            discrete,
            trajectory,
            ..
        } = result;
        let model = &optimum.model;
        let mut observed = observations(model, discrete);
        let origin = self.request.origin(true);
        let (control, feedback) = (self.control, self.loaded.feedback.as_ref());
        feedback_files::add(control, feedback, result, summary, files, &origin)?;
        let written = fields::write(files, model, discrete, &origin)?;
        summary.blocks = blocks::entries(model, &observed, written);
        observed.columns.extend(result.exchange.columns());
        let motion = Motion {
            model,
            discrete,
            trajectory,
            observations: &observed,
        };
        let shown =
            DisplayedMotion::from_motion(motion, &self.loaded.output, false, summary, files)?;
        self.write_pictures(motion, &shown, summary, files, &origin)
    }

    /// Writes tables, figures and page, next to the motion under the voltages of the goal alone.
    fn write_pictures(
        &self,
        motion: Motion<'_>,
        shown: &DisplayedMotion,
        summary: &Summary,
        files: &mut FileSet,
        origin: &Origin,
    ) -> Result<(), WriteError> {
        let (control, result) = (self.control, self.result);
        let optimum = &result.optimum;
        let Optimum {
            model, boundary, ..
        } = optimum;
        let is_solved = summary.message.is_none();
        let held = boundary.rest[1].as_ref().filter(|_| is_solved);
        let compared = held.map(|held| {
            let go_on = || ControlFlow::Continue(());
            let (start, motion) = (&boundary.start, &optimum.motion);
            let (other, _) = constant(model, start, motion, held, COMPARED, go_on);
            shown.beside(Trajectory::from_discrete(model, &other))
        });
        let goal = goal(model, boundary);
        let mut content = summary.page("Optimal control", Some(self.loaded));
        content.rows = rows(summary, self.system, control, result);
        content.plots = vec![convergence(&optimum.solution.iterations)];
        add_sensitivities(result, &mut content, files, origin)?;
        let run = Run {
            name: match summary.status.as_str() {
                _ if is_solved => "optimal voltages",
                "not_reproduced" | "not_held" => "optimum",
                _ => "last iterate",
            },
            comparison: compared.as_ref().map(|c| ("constant voltages", c)),
            held: boundary.rest[1].as_deref().filter(|_| is_solved),
            figures: self.request.figures,
            tracked: &shown.tracked(&summary.tracking),
            goal: goal.as_deref(),
            targets: &asked_places(control, motion.trajectory, true),
            waypoints: &asked_places(control, motion.trajectory, false),
            page: self.request.page.of(&content),
            ..shown.run(&model.system, origin)
        };
        write_run(files, &run)
    }
}

/// Adds to the summary what was observed of an optimal motion.
fn add_observed(summary: &mut Summary, result: &SolveResult) {
    summary.domain.clone_from(&result.outside);
    summary.energies = blocks::energies(&result.exchange);
    summary.tracking.clone_from(&result.tracking);
    summary.waypoint_values.clone_from(&result.waypoint_values);
    summary.final_values.clone_from(&result.final_values);
    summary.notes.clone_from(&result.remarks);
    let optimum = &result.optimum;
    let (system, motion) = (&optimum.model.system, &optimum.motion);
    let each = result.sensitivities.iter();
    let sections = each
        .clone()
        .map(|one| sensitivity_entries(system, motion, one));
    summary.sensitivities = sections.collect();
    let warnings = each.filter_map(tolerance_warning);
    summary.notes.warn("tolerance", warnings);
}

/// Writes the table and figures of sensitivities where there are any, and adds these to the page; those of an earlier run do not stay next to
/// other results.
fn add_sensitivities(
    result: &SolveResult,
    content: &mut PageContent,
    files: &mut FileSet,
    origin: &Origin,
) -> Result<(), WriteError> {
    let (list, system) = (&result.sensitivities, &result.optimum.model.system);
    let motion = &result.trajectory;
    let table = (!list.is_empty()).then(|| sensitivities::table(system, motion, list, origin));
    files.put("sensitivities.csv", table)?;
    let mut add = |file: &str, title: &str, plot: Option<LinePlot>| {
        let svg = plot.as_ref().map(|plot| plot.svg(origin));
        let titled = plot.map(|plot| (title.to_owned(), plot));
        content.plots.extend(titled);
        files.put(file, svg)
    };
    add(
        "sensitivities.svg",
        "Sensitivities",
        sensitivities::bars(list),
    )?;
    let voltages = sensitivities::voltages(system, motion, list);
    add(
        "voltages_tolerances.svg",
        "Voltages with tolerances",
        voltages,
    )
}

/// The part that all motions have in common, with their summaries in the order of the motions.
struct Together<'a> {
    request: &'a CommandInput,
    task: &'a ControlTask<'a>,
    result: &'a MotionsResult,
    each: &'a [Summary],
    /// `solved`, where each motion is, or the word of the first that is not.
    status: &'a str,
    folder: &'a Path,
}

impl Together<'_> {
    /// Writes the page of all side by side, and the summary last; returns the answer of the command.
    fn write(&self, began: Instant) -> Result<CommandOutput, CommandError> {
        let mut files = FileSet::in_folder(self.folder);
        remove_earlier(&mut files);
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
