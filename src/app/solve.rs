//! A control problem from file to folder: solved, re-simulated, and reported.

use std::ops::ControlFlow;
use std::path::Path;
use std::time::Instant;

use crate::app::blocks::BlockSizes;
use crate::app::continuation;
use crate::app::error::CommandError;
use crate::app::exchanged::Exchanged;
use crate::app::fields;
use crate::app::folder::make_folder;
use crate::app::linear_systems::LinearSystems;
use crate::app::moved_markers::moved_markers;
use crate::app::page;
use crate::app::progress::{Progress, Reached};
use crate::app::request::{CommandInput, CommandOutput};
use crate::app::shown::{Motion, Shown};
use crate::app::solution_file;
use crate::app::solve_page::{convergence, describe, goal, rows, targets};
use crate::app::solve_words::{carried, ends, meaning, redundancy, restarted, unresolved};
use crate::app::summary::{
    Evaluations, MEASURED, PerInterval, Program, Seconds, SoughtValue, Summary,
};
use crate::app::tracking_words;
use crate::app::unfinished::{self, Unfinished};
use crate::app::words::counted;
use crate::control::problem::{Control, Hold};
use crate::dynamics::{EnergyExchange, observations, out_of_domain};
use crate::files::Loaded;
use crate::files::problem::output::Output;
use crate::ipopt::{Status, interrupt};
use crate::model::System;
use crate::report::atomic::WriteError;
use crate::report::file_set::FileSet;
use crate::report::{Run, write_run};
use crate::workflow::Iterate;
use crate::workflow::accuracy::{Accuracy, AccuracyTarget, Refined};
use crate::workflow::cause::Cause;
use crate::workflow::cure::{Cured, reproduced};
use crate::workflow::domain;
use crate::workflow::effects::Plan;
use crate::workflow::final_values::final_values;
use crate::workflow::grids::optimise_to;
use crate::workflow::holding;
use crate::workflow::motion::{history, solved, trajectory};
use crate::workflow::optimum::{Optimum, SolveLimits};
use crate::workflow::resimulate::under_constant_voltages;
use crate::workflow::solve_remarks::add_remarks;
use crate::workflow::tracking::followed;
use crate::workflow::verified::{ACCURACY, verified};
use crate::workflow::violations::Violation;

/// Length of the motion under constant voltages that is drawn next to the optimal one, in durations.
const COMPARED: usize = 3;
/// Statuses of a solve that might have gone on.
const STOPPED: [&str; 3] = ["interrupted", "time_limit", "iteration_limit"];
/// Solves a control problem and writes its folder, solved or not.
pub(super) fn control(
    (request, asked): (&CommandInput, &[(String, String)]),
    loaded: &Loaded,
    control: &Control,
    began: Instant,
    observer: &mut dyn FnMut(Reached<'_>),
) -> Result<CommandOutput, CommandError> {
    let (system, output) = (&loaded.system, &loaded.output);
    let folder = request.folder();
    let mut unwritable = None;
    let mut unfinished = Unfinished::of(folder.join(solution_file::UNFINISHED));
    let read = began.elapsed().as_secs_f64();
    let allowed = SolveLimits {
        iterations: request.max_iterations,
        seconds: request.max_seconds.map(|s| (s - read).max(0.0)),
    };
    let Found {
        mut optimum,
        iterations,
        accuracy,
        note,
    } = {
        let progress = Progress::of_solve(request.progress);
        find(
            request,
            system,
            control,
            allowed,
            &mut |intervals, iterate| {
                let Iterate { report, model, .. } = *iterate;
                progress.iteration(intervals, report);
                observer(Reached::Iteration(intervals, report));
                // A folder that cannot be made is told before a long solve, not after it.
                if report.iteration == 0 && unwritable.is_none() {
                    unwritable = make_folder(&folder).err();
                }
                let (kept, motion) = iterate.before.unwrap_or((report, iterate.motion));
                unfinished.consider(kept.primal_infeasibility, |path| {
                    solution_file::replace(path, model, &motion())
                });
                match unwritable {
                    Some(_) => ControlFlow::Break(()),
                    None => ControlFlow::Continue(()),
                }
            },
        )?
    };
    if let Some(error) = unwritable {
        return Err(error.into());
    }
    make_folder(&folder)?;

    optimum.hold(control);
    let Optimum {
        model,
        boundary,
        motion: kept,
        solution,
        violated,
        resimulation,
        ..
    } = &optimum;
    let refuted = optimum.reversed.map(|(k, m)| unresolved(model, k, m));
    let refuted = refuted.or_else(|| optimum.cause().map(Cause::told));
    let tested = resimulation.as_ref();
    let not_kept = holding::warning(control, model, boundary, tested);
    let mut is_solved = optimum.is_solved();
    let mut word = optimum.word();
    if interrupt::requested() && word == "not_reproduced" {
        word = Status::Interrupted.word();
    }
    let has_to_hold = is_solved && control.hold == Hold::Required;
    let not_held = not_kept.clone().filter(|_| has_to_hold);
    if not_held.is_some() {
        (is_solved, word) = (false, "not_held");
    }
    let intervals = kept.intervals();
    let per_interval = |seconds: f64, evaluations: usize| {
        (evaluations > 0).then(|| 1e6 * seconds / (evaluations * intervals) as f64)
    };
    let seconds = &solution.seconds;
    let mut summary = Summary::new(request, word, model.coordinates.name());
    summary.message = refuted.or(not_held);
    if summary.message.is_none() && !is_solved {
        summary.message = Some(meaning(solution.status).to_owned());
    }
    if let (Some(message), false) = (&mut summary.message, optimum.meets_equations()) {
        message.push_str(&redundancy(&model.redundant_constraints(&boundary.start.z)));
    }
    summary.program = Some(Program {
        objective: solution.objective,
        objective_units: control.objective.units(system),
        iterations,
        intervals,
        duration: kept.times[intervals] / 1e3,
        variables: solution.x.len(),
        constraints: optimum.constraints,
        jacobian_nonzeros: optimum.jacobian_nonzeros,
        hessian_nonzeros: optimum.hessian_nonzeros,
        linear_solver: LinearSystems::new(&solution.linear),
        evaluations: Evaluations::new(&solution.evaluations),
        interval_microseconds: PerInterval {
            jacobian: per_interval(seconds.jacobian, solution.evaluations.jacobian),
            hessian: per_interval(seconds.hessian, solution.evaluations.hessian),
        },
        infeasibility: Some(optimum.infeasibility).filter(|value| value.is_finite()),
        violations: violated.clone(),
        resimulation: resimulation.clone(),
        parameters: kept.parameters.iter().map(SoughtValue::new).collect(),
        gap: Some(optimum.gap).filter(|gap| is_solved && gap.is_finite()),
        afterwards: optimum.afterwards.clone(),
    });
    let notes = &mut summary.notes;
    notes.note("start", control.start.notes().iter().cloned());
    notes.note("goal", boundary.notes.iter().cloned());
    notes.note("moved_marker", moved_markers(system));
    let not_kept = not_kept.filter(|_| is_solved);
    add_remarks(notes, control, &optimum, note, not_kept);
    notes.note("earlier_solution", carried(&optimum.carried));
    notes.note("second_start", optimum.restarted.map(restarted));
    summary.accuracy = accuracy;
    summary.plan = Plan::of(
        optimum.sought.as_ref().unwrap_or(model),
        Some(control),
        MEASURED,
    );
    summary.seconds = Seconds {
        total: began.elapsed().as_secs_f64(),
        setup: read + optimum.setup,
        solver: seconds.solver,
        objective: seconds.objective,
        gradient: seconds.gradient,
        constraints: seconds.constraints,
        jacobian: seconds.jacobian,
        hessian: seconds.hessian,
        ..Seconds::default()
    };
    write_files(
        (request, asked),
        &folder,
        (control, &optimum, output),
        &mut summary,
        began,
    )?;
    unfinished::done(&folder);
    let mut told = told(&summary, control.is_refined, violated, &folder);
    if STOPPED.contains(&word) {
        told.notes
            .extend(continuation::command(request, &loaded.task));
    }
    Ok(told)
}

/// The optimum that is written, and the way to it.
struct Found {
    optimum: Optimum,
    /// Iterations on the grids up to its own.
    iterations: usize,
    accuracy: Option<Accuracy>,
    /// Note on the reason for another grid than that of the problem.
    note: Option<String>,
}

/// Solves on the grid of the problem, or on finer ones where an accuracy is asked for.
fn find(
    request: &CommandInput,
    system: &System,
    control: &Control,
    allowed: SolveLimits,
    observer: &mut dyn FnMut(usize, &Iterate<'_>) -> ControlFlow<()>,
) -> Result<Found, CommandError> {
    let wanted = request.wanted.filter(|_| !control.is_refined);
    let Some(wanted) = wanted else {
        let Cured {
            optimum,
            iterations,
            note,
        } = match (control.is_refined, request.wanted) {
            (true, Some(AccuracyTarget::Below(part))) => {
                verified(system, control, part, allowed, observer)
            }
            (true, _) => verified(system, control, ACCURACY, allowed, observer),
            (false, _) => reproduced(system, control, allowed, observer),
        }
        .map_err(CommandError::of(&request.input))?;
        return Ok(Found {
            optimum,
            iterations,
            accuracy: None,
            note,
        });
    };
    let Refined {
        run: optimum,
        iterations,
        accuracy,
        ..
    } = optimise_to(system, control, wanted, allowed, observer)
        .map_err(CommandError::of(&request.input))?;
    Ok(Found {
        optimum,
        iterations,
        accuracy: Some(accuracy),
        note: None,
    })
}

fn write_files(
    (request, asked): (&CommandInput, &[(String, String)]),
    folder: &Path,
    (control, optimum, output): (&Control, &Optimum, &Output),
    summary: &mut Summary,
    began: Instant,
) -> Result<(), WriteError> {
    let writing = Instant::now();
    let Optimum {
        model,
        boundary,
        motion: kept,
        ..
    } = optimum;
    let mut files = FileSet::of(folder);
    solution_file::add(&mut files, model, kept)?;
    let history = history(model, kept);
    let mut observed = observations(model, &history);
    let origin = request.origin(true);
    let written = fields::write(&mut files, model, &history, &origin)?;
    summary.blocks = BlockSizes::of(model).map(|b| b.after(model, &observed, written));
    summary.domain = domain::told(&out_of_domain(model, &history));
    summary
        .notes
        .warn("outside_domain", domain::note(&summary.domain, true));
    let motion = trajectory(model, kept);
    let held = boundary.rest.each_ref().map(Option::as_deref);
    let exchange = EnergyExchange::new(&model.system, &motion, held);
    summary.energies = Exchanged::new(&exchange);
    observed.columns.extend(exchange.columns());
    summary.tracking = followed(optimum, control, &motion);
    summary
        .notes
        .note("tracking", tracking_words::told(&summary.tracking));
    summary.final_values = final_values(&model.system, control, &motion);
    summary
        .notes
        .note("final_value", ends(&summary.final_values));
    let shown = Shown::of(
        Motion {
            model,
            history: &history,
            trajectory: &motion,
            observations: &observed,
        },
        output,
        false,
        &mut files,
    )?;
    summary.notes.note("shown", shown.notes.iter().cloned());
    summary.shown = shown.part;
    let is_solved = summary.message.is_none();
    let compared = is_solved
        .then(|| under_constant_voltages(model, boundary, kept, COMPARED))
        .flatten()
        .map(|(history, _)| trajectory(model, &solved(model, &history, None)))
        .map(|other| shown.beside(other));
    let goal = goal(model, boundary);
    let mut told = page::told("Optimal control", summary, asked);
    told.rows = rows(summary);
    told.plots.push(convergence(&optimum.solution.iterations));
    let run = Run {
        name: match summary.status.as_str() {
            _ if is_solved => "optimal voltages",
            "not_reproduced" | "not_held" => "optimum",
            _ => "last iterate",
        },
        comparison: compared.as_ref().map(|c| ("constant voltages", c)),
        held: boundary.rest[1].as_deref().filter(|_| is_solved),
        figures: request.figures,
        tracked: &shown.tracked(&summary.tracking),
        goal: goal.as_deref(),
        targets: &targets(control, &motion),
        told: request.page.of(&told),
        ..shown.run(&model.system, &origin)
    };
    write_run(&mut files, &run)?;
    summary.seconds.wrote(began, writing);
    summary.write(files)
}

fn told(
    summary: &Summary,
    is_refined: bool,
    violated: &[Violation],
    folder: &Path,
) -> CommandOutput {
    let program = summary.program.as_ref();
    let (objective, iterations) = program.map_or((f64::NAN, 0), |p| (p.objective, p.iterations));
    let mut is_solved = summary.message.is_none();
    let solved = if is_solved { "solved" } else { "not solved" };
    let mut word = match summary.status.as_str() {
        "solved" => solved.to_owned(),
        word => format!("{solved} ({})", word.replace('_', " ")),
    };
    let mut notes: Vec<String> = summary.message.iter().cloned().collect();
    notes.extend(violated.iter().map(describe));
    notes.extend(summary.notes.lines());
    let parameters = program.iter().flat_map(|program| &program.parameters);
    notes.extend(parameters.map(|found| format!("{}: {}", found.name, found.told())));
    if let (true, Some(accuracy)) = (is_solved, &summary.accuracy) {
        notes.extend(accuracy.notes());
        (word, is_solved) = accuracy.outcome(&word);
    }
    let grid = match is_refined || summary.accuracy.is_some() {
        true => format!(
            ", {}",
            counted(program.map_or(0, |p| p.intervals), "interval")
        ),
        false => String::new(),
    };
    CommandOutput {
        is_solved,
        result: format!(
            "{word}: objective {objective:.7}{grid}, {}, {:.2} s, {}",
            counted(iterations, "iteration"),
            summary.seconds.total,
            folder.display()
        ),
        notes,
    }
}
