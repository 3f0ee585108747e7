//! A simulation from file to folder.

use std::ops::ControlFlow;
use std::path::Path;
use std::time::Instant;

use crate::app::blocks::BlockSizes;
use crate::app::comparison::{self, Comparison};
use crate::app::continuation;
use crate::app::error::CommandError;
use crate::app::exchanged::Exchanged;
use crate::app::fields;
use crate::app::folder::make_folder;
use crate::app::moved_markers::moved_markers;
use crate::app::page;
use crate::app::progress::{Progress, Reached};
use crate::app::request::{CommandInput, CommandOutput};
use crate::app::shown::{Motion, Shown};
use crate::app::solution_file;
use crate::app::summary::{self, MEASURED, Seconds, Summary};
use crate::app::unfinished::{self, Unfinished};
use crate::app::words::counted;
use crate::control::problem::{Afterwards, Simulation, Voltages};
use crate::dynamics::trajectory::Trajectory;
use crate::dynamics::{
    DiscreteTrajectory, EnergyExchange, local_error_of, observed, out_of_domain,
};
use crate::files::{Loaded, continuation as continuation_file};
use crate::ipopt::interrupt;
use crate::math::join;
use crate::model::Model;
use crate::report::atomic::{self, WriteError};
use crate::report::file_set::FileSet;
use crate::report::{Run, write_run};
use crate::workflow::domain;
use crate::workflow::effects::Plan;
use crate::workflow::grids::integrate_to;
use crate::workflow::integrate::{Simulated, grid, integrate_on};
use crate::workflow::motion::{solved, solved_of};
use crate::workflow::phase::phase;
use crate::workflow::steps;

/// Simulates and writes the folder; a motion that ends early is kept as far as it went.
pub(super) fn simulation(
    (request, asked): (&CommandInput, &[(String, String)]),
    loaded: &Loaded,
    task: &Simulation,
    began: Instant,
    observer: &mut dyn FnMut(Reached<'_>),
) -> Result<CommandOutput, CommandError> {
    let (system, output) = (&loaded.system, &loaded.output);
    let (steps, _) = grid(task);
    if task.tolerance.is_some() && request.wanted.is_some() {
        return Err(CommandError::Problem {
            file: request.input.clone(),
            place: "simulate.step".to_owned(),
            reason: "steps are halved for --accuracy and --estimate-error: write a step; \"auto\" has a \"tolerance\" instead"
                .to_owned(),
        });
    }
    let problem = continuation::asked(loaded, task);
    let from = request.from.as_ref();
    let begun = from.map(|from| continuation::begun(from, &problem, task));
    let begun = begun.transpose()?;
    let folder = request.folder();
    let read = began.elapsed().as_secs_f64();
    let mut unwritable = None;
    // Steps that are halved begin anew: what is kept of them is no motion to go on with.
    let goes_on = request.wanted.is_none();
    let mut unfinished = Unfinished::of(folder.join(match goes_on {
        true => continuation::UNFINISHED,
        false => solution_file::UNFINISHED,
    }));
    let watch = interrupt::watch(request.max_seconds.map(|s| s - read));
    let (
        Simulated {
            model,
            history,
            failure,
            error,
            setup,
            seconds: spent,
        },
        accuracy,
    ) = {
        let progress = Progress::of_steps(request.progress, steps);
        let mut observe = |steps: usize, model: &Model, history: &DiscreteTrajectory| {
            let step = history.intervals();
            progress.step(steps, step);
            observer(Reached::Step(step, history.times[step]));
            // A folder that cannot be made is told before a long run, not after it.
            if step == 1 && unwritable.is_none() {
                unwritable = make_folder(&folder).err();
            }
            // The steps so far are final; those of a finer grid begin anew.
            unfinished.consider(0.0, |path| match goes_on {
                true => write_continuation(path, history, &problem),
                false => solution_file::replace(path, model, &solved(model, history, None)),
            });
            match unwritable {
                Some(_) => ControlFlow::Break(()),
                None => ControlFlow::Continue(()),
            }
        };
        match request.wanted {
            None => {
                let run = integrate_on(system, task, begun, |model, history| {
                    observe(steps, model, history)
                })
                .map_err(CommandError::of(&request.input))?;
                (run, None)
            }
            Some(wanted) => {
                let left = request.max_seconds.map(|s| s - read);
                let found = integrate_to(system, task, wanted, left, &mut observe)
                    .map_err(CommandError::of(&request.input))?;
                (found.run, Some(found.accuracy))
            }
        }
    };
    // A finer grid that was stopped leaves the motion on the one before as it is.
    let reached = history.times[history.intervals()];
    let is_early = reached < task.duration * (1.0 - 1e-12);
    let stopped = interrupt::stop().filter(|_| is_early);
    drop(watch);
    if let Some(error) = unwritable {
        return Err(error.into());
    }
    make_folder(&folder)?;
    phase("writing");
    let writing = Instant::now();
    let plan = Plan::of(&model, None, MEASURED);
    let status = match (&failure, stopped) {
        (Some(_), _) => "step_failed",
        (None, Some(stopped)) => stopped.word(),
        (None, None) => "simulated",
    };

    let mut files = FileSet::of(&folder);
    let origin = request.origin(false);
    let integrator = task.solving.integrator;
    let ends = [task.start.voltages(), None];
    // Of many steps each takes long, and most need no other.
    let (columns, (motion, written, seen)) = join(
        || observed(&model, &history),
        || {
            let motion = Trajectory::from_history(&model, &history);
            let write = || {
                let goes_on = goes_on.then_some(&*problem);
                write_motion(&mut files, (&model, &history, &motion), goes_on)?;
                fields::write(&mut files, &model, &history, &origin)
            };
            let see = || {
                let steps = (&history, &motion);
                (
                    out_of_domain(&model, &history),
                    local_error_of(&model, steps, integrator.order()),
                    EnergyExchange::new(&model.system, &motion, ends),
                )
            };
            let (written, seen) = join(write, see);
            (motion, written, seen)
        },
    );
    let ((outside, neglected, exchange), written) = (seen, written?);
    let mut observed = motion.observe(&model.system);
    observed.columns.extend(columns);
    let mut summary = Summary::new(request, status, model.coordinates.name());
    summary.message = failure.as_ref().map(ToString::to_string);
    summary.accuracy = accuracy;
    let simulation = summary::Simulation::new((&history, error), task, neglected);
    summary.simulation = Some(simulation);
    summary.plan = plan;
    summary.domain = domain::told(&outside);
    summary.blocks = BlockSizes::of(&model).map(|b| b.after(&model, &observed, written));
    summary.seconds = Seconds {
        total: began.elapsed().as_secs_f64(),
        setup: read + setup,
        solver: spent,
        ..Seconds::default()
    };
    summary.energies = Exchanged::new(&exchange);
    observed.columns.extend(exchange.columns());
    let path = task.voltages.solution();
    let earlier = path.and_then(|path| comparison::earlier(&model, path));
    summary.comparison = path
        .zip(earlier.as_ref())
        .map(|(path, earlier)| Comparison::new(&model, path, &motion, earlier));
    let compared = summary.comparison.iter().flat_map(Comparison::notes);
    let mut notes: Vec<String> = summary.message.iter().cloned().chain(compared).collect();
    let remarks = &mut summary.notes;
    remarks.note("start", task.start.notes().iter().cloned());
    remarks.note("moved_marker", moved_markers(system));
    remarks.note("voltages_end", afterwards(task));
    remarks.note("step_divided", steps::divided(task));
    remarks.warn("outside_domain", domain::note(&summary.domain, true));
    remarks.warn("coarse_steps", steps::told(neglected, &history, task));
    remarks.warn("tolerance_exceeded", steps::beyond(error, task));
    remarks.warn("energy_balance", steps::unbalanced(&history));
    let shown = Shown::of(
        Motion {
            model: &model,
            history: &history,
            trajectory: &motion,
            observations: &observed,
        },
        output,
        true,
        &mut files,
    )?;
    summary.notes.note("shown", shown.notes.iter().cloned());
    summary.shown = shown.part;
    notes.extend(summary.notes.lines());
    let method = match task.tolerance {
        Some(tolerance) => format!(
            "{}, steps by a tolerance of {tolerance:e} (unequal steps keep momentum maps, not the energy over long times)",
            integrator.name()
        ),
        None => integrator.name(),
    };
    let mut rows = vec![
        ("status".to_owned(), status.replace('_', " ")),
        ("steps".to_owned(), steps::counted(&history, task)),
        ("duration".to_owned(), format!("{} s", reached / 1e3)),
        ("method".to_owned(), method),
        (
            "coordinates".to_owned(),
            model.coordinates.name().to_owned(),
        ),
        ("time".to_owned(), format!("{:.3} s", summary.seconds.total)),
    ];
    rows.extend(summary.energies.iter().flat_map(Exchanged::rows));
    rows.extend(summary.accuracy.iter().flat_map(|a| {
        let told = |(name, error): (&&str, &f64)| {
            (format!("estimated error, {name}"), format!("{error:.1e}"))
        };
        a.estimate.iter().map(told)
    }));
    rows.extend(neglected.map(|error| {
        let words = format!(
            "{:.2e} m, {:.2} % of the path",
            error.error / 1e3,
            100.0 * error.relative()
        );
        ("sum of the local errors of the steps".to_owned(), words)
    }));
    let mut told = page::told("Simulation", &summary, asked);
    told.rows = rows;
    let earlier = earlier.map(|earlier| shown.beside(earlier));
    let run = Run {
        name: "simulation",
        comparison: earlier.as_ref().map(|e| ("the solution", e)),
        held: held(task, reached),
        figures: request.figures,
        told: request.page.of(&told),
        ..shown.run(system, &origin)
    };
    write_run(&mut files, &run)?;
    summary.seconds.wrote(began, writing);
    summary.write(files)?;
    unfinished::done(&folder);
    let mut is_solved = status == "simulated";
    let mut word = match is_solved {
        true => "simulated".to_owned(),
        false => format!("not simulated to the end ({})", status.replace('_', " ")),
    };
    if stopped.is_some() && goes_on {
        notes.extend(continuation::command(request, &loaded.task));
    }
    if let (true, Some(accuracy)) = (is_solved, &summary.accuracy) {
        notes.extend(accuracy.notes());
        (word, is_solved) = accuracy.outcome(&word);
    }
    Ok(CommandOutput {
        is_solved,
        result: format!(
            "{word}: {}, {} s of motion, {:.2} s, {}",
            counted(history.intervals(), "step"),
            reached / 1e3,
            summary.seconds.total,
            folder.display()
        ),
        notes,
    })
}

/// Adds the motion to the files of a result, with the state from which it can be resumed.
fn write_motion(
    files: &mut FileSet,
    (model, history, motion): (&Model, &DiscreteTrajectory, &Trajectory),
    goes_on: Option<&str>,
) -> Result<(), WriteError> {
    let is_motion = motion.intervals() > 0;
    if is_motion {
        let kept = solved_of(model, history, motion.clone(), None);
        solution_file::add(files, model, &kept)?;
    }
    match goes_on.filter(|_| is_motion) {
        Some(asked) => {
            let path = files.folder().join(continuation::ENDED);
            let bytes = continuation_file::bytes(history, asked);
            let bytes = bytes.map_err(|cause| WriteError { path, cause })?;
            files.add(continuation::ENDED, &bytes)
        }
        None => {
            files.remove(continuation::ENDED);
            Ok(())
        }
    }
}

/// Writes the motion so far by itself.
fn write_continuation(
    path: &Path,
    history: &DiscreteTrajectory,
    asked: &str,
) -> Result<(), WriteError> {
    let bytes = continuation_file::bytes(history, asked);
    let bytes = bytes.map_err(|cause| WriteError {
        path: path.to_owned(),
        cause,
    })?;
    atomic::write(path, &bytes)
}

/// Voltages in V that the solution or table says to hold from the end of the motion on, which it reached.
fn held(task: &Simulation, reached: f64) -> Option<&[f64]> {
    match &task.voltages {
        Voltages::Sampled {
            ends,
            rows,
            afterwards: Afterwards::Held,
            ..
        } if reached >= ends[ends.len() - 1] * (1.0 - 1e-9) => rows.last().map(Vec::as_slice),
        _ => None,
    }
}

/// Notes the voltages after the end of the solution from which a simulation takes them, where it goes on for longer.
fn afterwards(task: &Simulation) -> Option<String> {
    let Voltages::Sampled {
        ends,
        afterwards,
        solution,
        ..
    } = &task.voltages
    else {
        return None;
    };
    let end = ends[ends.len() - 1];
    let named = solution.as_ref().map(|path| path.display().to_string());
    let of_solution = named.is_some();
    let source = named.unwrap_or_else(|| "the table".to_owned());
    (task.duration > end * (1.0 + 1e-9)).then(|| match afterwards {
        Afterwards::Held if of_solution => {
            format!("after {} s the voltages that hold the goal of {source} are held", end / 1e3)
        }
        Afterwards::Held => format!("after {} s the voltages of \"hold\" are held", end / 1e3),
        Afterwards::OfLastInterval if of_solution => format!(
            "after {} s the voltages of the last interval are held: {source} has no \"hold\", voltages that hold its goal",
            end / 1e3
        ),
        Afterwards::OfLastInterval => format!(
            "after {} s the voltages of the last interval are held: {source} has no \"hold\"",
            end / 1e3
        ),
    })
}
