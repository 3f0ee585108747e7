//! A control problem from file to folder: solved, re-simulated, and reported.

use std::ops::ControlFlow;
use std::time::Instant;

use crate::app::blocks::{self, EnergySummary};
use crate::app::displayed_motion::{DisplayedMotion, Motion};
use crate::app::error::CommandError;
use crate::app::kept::overwrite_check::{folder_within, make_folder_of};
use crate::app::kept::partial_result::{STOPPED, leave_out, time_to_write};
use crate::app::kept::{resume_file, solution_file, unfinished};
use crate::app::motions::Together;
use crate::app::progress::Reached;
use crate::app::request::{CommandInput, CommandOutput};
use crate::app::solve_summary::{
    command_output, convergence, goal, program, rows, seconds, targets, waypoints,
};
use crate::app::summary::{MEASURED, Summary};
use crate::app::{feedback_files, fields, sensitivity_summary};
use crate::control::problem::{Control, Regulator};
use crate::dynamics::observations;
use crate::dynamics::trajectory::Trajectory;
use crate::files::Loaded;
use crate::model::System;
use crate::report::atomic::WriteError;
use crate::report::file_set::FileSet;
use crate::report::origin::Origin;
use crate::report::{Run, sensitivities, write_run};
use crate::stop;
use crate::tasks::SolveResult;
use crate::workflow::effects::Plan;
use crate::workflow::optimum::Optimum;
use crate::workflow::resimulate::constant;

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
            feedback: loaded.feedback.as_ref(),
            result: one,
        };
        each.push(solved.write(read, began)?);
        unfinished::done(&own.folder());
    }
    let stopped = each.iter().find(|one| STOPPED.contains(&&*one.status));
    // Of the results of a motion not all was written.
    let status = stopped.map_or(result.verdict.word, |one| &one.status);
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

/// A motion of a problem, solved or not, with the feedback along it.
struct Solved<'a> {
    request: &'a CommandInput,
    loaded: &'a Loaded,
    system: &'a System,
    control: &'a Control,
    feedback: Option<&'a Regulator>,
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
        let (control, feedback) = (self.control, self.feedback);
        feedback_files::add(control, feedback, result, summary, files, &origin)?;
        let written = fields::write(files, model, discrete, &origin)?;
        summary.blocks = blocks::entries(model, &observed, written);
        observed.columns.extend(result.exchange.columns());
        write_sensitivities(result, files, &origin)?;
        let motion = Motion {
            model,
            discrete,
            trajectory,
            observations: &observed,
        };
        let shown = DisplayedMotion::from_motion(motion, &self.loaded.output, false, files)?;
        summary.notes.note("shown", shown.notes.iter().cloned());
        summary.shown = shown.part;
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
        content
            .plots
            .push(convergence(&optimum.solution.iterations));
        let list = &result.sensitivities;
        let bars = sensitivities::bars(list).map(|plot| ("Sensitivities", plot));
        let voltages = sensitivities::voltages(&model.system, &result.trajectory, list);
        let voltages = voltages.map(|plot| ("Voltages with tolerances", plot));
        let plots = bars.into_iter().chain(voltages);
        content
            .plots
            .extend(plots.map(|(title, plot)| (title.to_owned(), plot)));
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
            targets: &targets(control, motion.trajectory),
            waypoints: &waypoints(control, motion.trajectory),
            page: self.request.page.of(&content),
            ..shown.run(&model.system, origin)
        };
        write_run(files, &run)
    }
}

/// Adds to the summary what was observed of an optimal motion.
fn add_observed(summary: &mut Summary, result: &SolveResult) {
    summary.domain.clone_from(&result.outside);
    summary.energies = EnergySummary::new(&result.exchange);
    summary.tracking.clone_from(&result.tracking);
    summary.waypoint_values.clone_from(&result.waypoint_values);
    summary.final_values.clone_from(&result.final_values);
    summary.notes.clone_from(&result.remarks);
    let optimum = &result.optimum;
    let (system, motion) = (&optimum.model.system, &optimum.motion);
    let each = result.sensitivities.iter();
    let sections = each
        .clone()
        .map(|one| sensitivity_summary::entries(system, motion, one));
    summary.sensitivities = sections.collect();
    let warnings = each.filter_map(sensitivity_summary::warning);
    summary.notes.warn("tolerance", warnings);
}

/// Writes tables and figures of sensitivities where there are any; those of an earlier run do not stay next to other results.
fn write_sensitivities(
    result: &SolveResult,
    files: &mut FileSet,
    origin: &Origin,
) -> Result<(), WriteError> {
    let (list, system) = (&result.sensitivities, &result.optimum.model.system);
    let is_any = !list.is_empty();
    let table = is_any.then(|| sensitivities::table(system, &result.trajectory, list, origin));
    files.put("sensitivities.csv", table)?;
    let bars = sensitivities::bars(list).map(|plot| plot.svg(origin));
    files.put("sensitivities.svg", bars)?;
    let voltages = sensitivities::voltages(system, &result.trajectory, list);
    let voltages = voltages.map(|plot| plot.svg(origin));
    files.put("voltages_tolerances.svg", voltages)
}
