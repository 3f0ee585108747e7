//! A simulation from file to folder.

use std::ops::ControlFlow;
use std::time::Instant;

use crate::control::problem::{Simulation, Voltages};
use crate::control::resolve_start;
use crate::dynamics::observations;
use crate::dynamics::simulate_by;
use crate::ipopt::interrupt;
use crate::model::{Model, System};
use crate::report::skins::Skins;
use crate::report::{Run, write_run};
use crate::run::blocks::Blocks;
use crate::run::comparison::{self, Comparison};
use crate::run::effects::Plan;
use crate::run::error::RunError;
use crate::run::fields;
use crate::run::motion::{solved, trajectory};
use crate::run::progress::Progress;
use crate::run::request::{Request, Told};
use crate::run::solution_file;
use crate::run::solve::{counted, make_folder};
use crate::run::summary::{self, MEASURED, Seconds, Summary};

/// Simulates and writes the folder; a motion that ends early is kept as far as it went.
///
/// The steps are equal: as long as asked for, or a little shorter where they do not fit the duration.
pub(super) fn simulation(
    request: &Request,
    system: &System,
    task: &Simulation,
    began: Instant,
) -> Result<Told, RunError> {
    let steps = (task.duration / task.step - 1e-9).ceil().max(1.0) as usize;
    let h = task.duration / steps as f64;
    let wrong = |error| RunError::boundary(&request.input, "simulate", &error);
    let model = Model::answering(system.clone(), task.question(system, h))
        .map_err(|error| wrong(error.into()))?;
    let start = resolve_start(&model, &task.start, "start").map_err(wrong)?;
    let plan = Plan::of(&model, None, MEASURED).map_err(|error| wrong(error.into()))?;
    let folder = request.folder();
    make_folder(&folder)?;

    let setup = began.elapsed().as_secs_f64();
    let scalars = |from: f64, to: f64| model.scalars(row(&task.voltages, 0.5 * (from + to)));
    let mut stopped = None;
    let (history, failure) = {
        let progress = Progress::of_steps(request.progress, steps);
        simulate_by(task.solving, &model, &start, h, steps, scalars, |step| {
            progress.step(step);
            let late = |limit: f64| began.elapsed().as_secs_f64() > limit;
            stopped = match step < steps {
                true if interrupt::requested() => Some("interrupted"),
                true if request.max_seconds.is_some_and(late) => Some("time_limit"),
                _ => return ControlFlow::Continue(()),
            };
            ControlFlow::Break(())
        })
    };
    let spent = began.elapsed().as_secs_f64() - setup;
    let reached = history.times[history.intervals()];
    let status = match (&failure, stopped) {
        (Some(_), _) => "step_failed",
        (None, Some(word)) => word,
        (None, None) => "simulated",
    };

    let kept = solved(&model, &history, None);
    if kept.intervals() > 0 {
        solution_file::write(&folder.join("solution.json"), &model, &kept)?;
    }
    let mut summary = Summary::new(request, status, model.coordinates.name());
    summary.message = failure.as_ref().map(ToString::to_string);
    summary.simulation = Some(summary::Simulation::new(&history));
    summary.plan = plan;
    let observed = observations(&model, &history);
    let origin = request.origin(false);
    let written = fields::write(&folder, &model, &history, &origin)?;
    summary.blocks = Blocks::of(&model).map(|b| b.after(&model, &observed, written));
    summary.seconds = Seconds {
        total: began.elapsed().as_secs_f64(),
        setup,
        solver: spent,
        ..Seconds::default()
    };
    let motion = trajectory(&model, &kept);
    let path = task.voltages.solution();
    let earlier = path.and_then(|path| comparison::earlier(&model, path));
    summary.comparison = path
        .zip(earlier.as_ref())
        .map(|(path, earlier)| Comparison::new(&model, path, &motion, earlier));
    let compared = summary.comparison.iter().flat_map(Comparison::notes);
    let notes = summary.message.iter().cloned().chain(compared).collect();
    summary.write(&folder)?;
    let rows = [
        ("status".to_owned(), status.replace('_', " ")),
        ("steps".to_owned(), history.intervals().to_string()),
        ("duration".to_owned(), format!("{} s", reached / 1e3)),
        (
            "coordinates".to_owned(),
            model.coordinates.name().to_owned(),
        ),
        ("time".to_owned(), format!("{:.3} s", summary.seconds.total)),
    ];
    let run = Run {
        system,
        trajectory: &motion,
        skins: &Skins::new(&model, &history),
        name: "simulation",
        observations: &observed,
        comparison: earlier.as_ref().map(|e| ("the solution", e)),
        held: None,
        origin: &origin,
        title: "Simulation",
        summary: &rows,
    };
    write_run(&folder, &run)?;
    let is_solved = status == "simulated";
    Ok(Told {
        is_solved,
        result: format!(
            "{}: {}, {} s of motion, {:.2} s, {}",
            match is_solved {
                true => "simulated".to_owned(),
                false => format!("not simulated to the end ({})", status.replace('_', " ")),
            },
            counted(history.intervals(), "step"),
            reached / 1e3,
            summary.seconds.total,
            folder.display()
        ),
        notes,
    })
}

/// Voltages at a time in ms.
fn row(voltages: &Voltages, time: f64) -> &[f64] {
    match voltages {
        Voltages::Constant(row) => row,
        Voltages::Sampled { ends, rows, .. } => {
            let k = ends.iter().position(|&end| time < end);
            &rows[k.unwrap_or(rows.len() - 1)]
        }
    }
}
