//! An identification from file to folder.

use crate::app::error::CommandError;
use crate::app::identification_summary::{Identification, remarks, status};
use crate::app::kept::record::make_folder_of;
use crate::app::request::{CommandInput, CommandOutput, PageWanted};
use crate::app::summary::{Seconds, Summary, remove_earlier};
use crate::control::problem;
use crate::dynamics::trajectory::Trajectory;
use crate::files::Loaded;
use crate::identify::{
    Ended, Experiment, FittedMotion, Identified, IdentifyError, Problem, Series, identify,
};
use crate::math::significant;
use crate::nlp::Status;
use crate::report::file_set::FileSet;
use crate::report::lines::{LinePlot, Mark, Series as Curve, over_time};
use crate::report::page::html;
use crate::report::skins::Skins;
use crate::report::table::{aligned, cells_csv};
use crate::report::{Run, style};
use crate::stop;
use crate::workflow::remark::phase;
use std::time::Instant;

/// Fits the constants of a task to its recordings and writes the folder.
pub(super) fn run(
    request: &CommandInput,
    loaded: &Loaded,
    task: &problem::Identification,
    began: Instant,
) -> Result<CommandOutput, CommandError> {
    let (system, read) = (&loaded.system, began.elapsed().as_secs_f64());
    let watch = stop::watch(request.max_seconds.map(|seconds| seconds - read));
    phase("fitting");
    let found = identify(system, task, &mut |fit, grid| {
        tracing::debug!(intervals = ?grid.intervals, sum = fit.sum(), "fitted");
    });
    let found = found.map_err(|error| refused(request, &error))?;
    let is_complete = found.fit.ended == Ended::Converged && found.bias.is_confirmed;
    let stopped = stop::reason().filter(|_| !is_complete);
    drop(watch);
    let motions = FittedMotion::all(Problem { system, task }, &found);
    let folder = make_folder_of(request)?;
    let writing = Instant::now();
    let origin = request.origin(false);
    let status = stopped.map_or_else(|| status(&found), Status::word);
    let mut summary = Summary::new(request, status, None);
    summary.notes = remarks(task, &found);
    summary.notes.note("units", loaded.notes.clone());
    if stopped.is_some() {
        let text = "it was stopped: constants and intervals are those of the last step of a fit on the last grid";
        summary.notes.warn("stopped", [text.to_owned()]);
    }
    let identification = Identification {
        system,
        task,
        found: &found,
        motions: &motions,
    };
    let text = identification.text();
    summary.task = identification.entries();
    let mut files = FileSet::in_folder(&folder);
    remove_earlier(&mut files);
    files.add(
        "residuals.csv",
        cells_csv(&table(task, &found), &origin).as_bytes(),
    )?;
    summary.seconds = Seconds::since(began, read);
    if request.page == PageWanted::Written {
        let page = page(identification, request, loaded, &summary);
        files.add("report.html", page.as_bytes())?;
    }
    summary.seconds.wrote(began, writing);
    let notes = summary.notes.lines().collect();
    summary.write(files)?;
    Ok(CommandOutput {
        is_solved: stopped.is_none() && is_solved(&found),
        result: format!("{}\n{text}\n{}", status.replace('_', " "), folder.display()),
        notes,
    })
}

/// Returns true if the constants are found and explain what was held out.
fn is_solved(found: &Identified) -> bool {
    matches!(status(found), "identified" | "explained")
}

fn refused(request: &CommandInput, error: &IdentifyError) -> CommandError {
    // What is interrupted may end in other errors too.
    if let Err(stopped) = stop::check() {
        return stopped.into();
    }
    let place = match error {
        IdentifyError::NotSought(_) | IdentifyError::Unread { .. } => "identify.free",
        IdentifyError::Candidate { .. } => "identify.candidates",
        _ => "identify.recordings",
    };
    CommandError::problem(&request.input, place, error.to_string())
}

/// All readings with their predictions as rows of cells, in SI units.
fn table(task: &problem::Identification, found: &Identified) -> Vec<Vec<String>> {
    let header = [
        "recording",
        "quantity",
        "unit",
        "time [s]",
        "measured",
        "predicted",
        "residual",
        "standard deviation",
        "held out",
    ];
    let mut rows = vec![header.map(str::to_owned).to_vec()];
    for one in series(found) {
        let recording = &task.recordings[one.recording];
        let channel = &recording.channels[one.channel];
        let (symbol, factor) = channel.unit;
        for k in 0..one.times.len() {
            let (measured, predicted) = (one.measured[k], one.predicted[k]);
            let numbers = [measured, predicted, measured - predicted, one.deviations[k]];
            let mut row = vec![
                recording.name.clone(),
                channel.name.clone(),
                symbol.to_owned(),
                format!("{}", one.times[k] / 1e3),
            ];
            row.extend(numbers.map(|number| format!("{}", factor * number)));
            row.push(recording.is_held_out.to_string());
            rows.push(row);
        }
    }
    rows
}

/// The page: constants with their errors, verdicts, correlations and the next experiments, and each recording as the fit predicts it.
fn page(
    identification: Identification<'_>,
    request: &CommandInput,
    loaded: &Loaded,
    summary: &Summary,
) -> String {
    let Identification { task, found, .. } = identification;
    let mut content = summary.page("Identification", Some(loaded));
    content.is_solved = is_solved(found);
    content.notes.splice(0..0, identification.verdicts());
    content.rows = identification.rows();
    content.rows.extend(summary.rows());
    let mut add = |name: &str, rows: &[Vec<String>]| {
        let table = (rows.len() > 1).then(|| (name.to_owned(), aligned(rows)));
        content.documents.extend(table);
    };
    add("Correlation", &correlations(task, found));
    let after = experiments(task, found);
    add("Standard errors after the next experiment", &after);
    let shown = identification.motions.iter().map(|motion| {
        let (model, discrete) = (&motion.model, &motion.discrete);
        let of_recording = series(found).filter(|one| one.recording == motion.recording);
        let plots: Vec<_> = of_recording.flat_map(|one| plots(task, one)).collect();
        let trajectory = Trajectory::from_discrete(model, discrete);
        let skins = Skins::new(model, discrete);
        (motion, trajectory, skins, plots)
    });
    let (shown, origin) = (shown.collect::<Vec<_>>(), request.origin(false));
    let runs = shown.iter().map(|(motion, trajectory, skins, plots)| Run {
        name: &task.recordings[motion.recording].name,
        plots,
        figures: request.figures,
        ..Run::from_trajectory(
            &motion.model.system,
            trajectory,
            skins,
            &motion.observations,
            &origin,
        )
    });
    html(
        &loaded.system.name,
        &runs.collect::<Vec<_>>(),
        &content,
        &origin,
    )
}

/// Residuals of all recordings, those that are held out last.
fn series(found: &Identified) -> impl Iterator<Item = &Series> {
    let held_out = found.held_out.iter().flat_map(|one| &one.series);
    found.series.iter().chain(held_out)
}

/// Correlations of the constants that have intervals; none of fewer than two.
fn correlations(task: &problem::Identification, found: &Identified) -> Vec<Vec<String>> {
    let has = |&j: &usize| found.information.is_determined[j] && !found.fit.is_at_bound[j];
    let all: Vec<usize> = (0..task.parameters.len()).filter(has).collect();
    if all.len() < 2 {
        return Vec::new();
    }
    let name = |&j: &usize| task.parameters[j].name.clone();
    let head = [String::new()].into_iter().chain(all.iter().map(name));
    let row = |i: &usize| -> Vec<String> {
        let cell = |j: &usize| format!("{:.3}", found.information.correlation(*i, *j));
        [name(i)].into_iter().chain(all.iter().map(cell)).collect()
    };
    [head.collect()]
        .into_iter()
        .chain(all.iter().map(row))
        .collect()
}

/// The next experiments, the best one first, with the relative standard errors that are left.
fn experiments(task: &problem::Identification, found: &Identified) -> Vec<Vec<String>> {
    let names = task
        .parameters
        .iter()
        .map(|parameter| parameter.name.clone());
    let head = [String::new()].into_iter().chain(names);
    let row = |one: &Experiment| -> Vec<String> {
        let error = |(j, value): (usize, &f64)| match one.information.is_determined[j] {
            true => {
                let variance = one.information.covariance[(j, j)];
                format!(
                    "{} %",
                    significant(100.0 * variance.sqrt() / value.abs(), 2)
                )
            }
            false => "not determined".to_owned(),
        };
        let errors = found.fit.of_constants().iter().enumerate().map(error);
        let name = task.candidates[one.candidate].name.clone();
        [name].into_iter().chain(errors).collect()
    };
    let rows = found.experiments.iter().map(row);
    [head.collect()].into_iter().chain(rows).collect()
}

/// Measured against predicted, and residuals, of one quantity of one recording, with their titles.
fn plots(task: &problem::Identification, one: &Series) -> [(String, LinePlot); 2] {
    let recording = &task.recordings[one.recording];
    let channel = &recording.channels[one.channel];
    let (symbol, factor) = channel.unit;
    let points = |values: &[f64]| over_time(&one.times, values.iter().map(|v| factor * v));
    let measured = Curve::curve("measured", points(&one.measured), style::hue(1));
    let predicted = Curve::curve("predicted", points(&one.predicted), style::hue(0));
    let above = LinePlot::over_time(
        format!("{} [{symbol}]", channel.name),
        vec![predicted, measured.marked(Mark::Ring).unjoined()],
    );
    let residuals = over_time(&one.times, one.standardised());
    let residuals = Curve::curve("residual", residuals, style::hue(1));
    let below = LinePlot {
        frame: [400.0, 120.0],
        ..LinePlot::over_time(
            "residual [σ]",
            vec![residuals.marked(Mark::Disc).unjoined()],
        )
    };
    let held_out = match recording.is_held_out {
        true => ", held out",
        false => "",
    };
    let title = format!("{}{held_out}", channel.name);
    let residuals = format!("{title}, residuals");
    [(title, above), (residuals, below)]
}
