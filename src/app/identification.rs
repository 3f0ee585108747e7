//! An identification from file to folder.

use crate::app::error::CommandError;
use crate::app::identification_page;
use crate::app::identification_summary::Identification;
use crate::app::identification_verdict::{remarks, status};
use crate::app::overwrite_check::make_folder_of;
use crate::app::partial_result::EARLIER;
use crate::app::request::{CommandInput, CommandOutput, PageWanted};
use crate::app::summary::Summary;
use crate::control::problem;
use crate::files::Loaded;
use crate::identify::{Ended, Identified, IdentifyError, found_starts, identify};
use crate::nlp::Status;
use crate::report::file_set::FileSet;
use crate::report::table::cells_csv;
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
    let read = began.elapsed().as_secs_f64();
    let watch = stop::watch(request.max_seconds.map(|seconds| seconds - read));
    phase("fitting");
    let found = identify(&loaded.system, task, &mut |fit, grid| {
        tracing::debug!(intervals = ?grid.intervals, sum = fit.sum(), "fitted");
    });
    let found = found.map_err(|error| refused(request, &error))?;
    let starts = found_starts(&loaded.system, task, &found);
    let starts = starts.map_err(|error| refused(request, &error))?;
    let is_complete = found.fit.ended == Ended::Converged && found.bias.is_confirmed;
    let stopped = stop::reason().filter(|_| !is_complete);
    drop(watch);
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
    let identification = Identification::new(&loaded.system, task, (&found, &starts));
    let text = identification.text();
    summary.identification = Some(identification);
    let mut files = FileSet::in_folder(&folder);
    EARLIER.iter().for_each(|name| files.remove(name));
    files.add(
        "residuals.csv",
        cells_csv(&table(task, &found), &origin).as_bytes(),
    )?;
    if request.page == PageWanted::Written {
        let page = identification_page::html(task, loaded, &found, &summary, &origin);
        files.add("report.html", page.as_bytes())?;
    }
    summary.seconds.setup = read;
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
    CommandError::Problem {
        file: request.input.clone(),
        place: place.to_owned(),
        reason: error.to_string(),
    }
}

/// All readings with their predictions as rows of cells, in SI units.
pub(super) fn table(task: &problem::Identification, found: &Identified) -> Vec<Vec<String>> {
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
    let held_out = found.held_out.iter().flat_map(|one| &one.series);
    for one in found.series.iter().chain(held_out) {
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
