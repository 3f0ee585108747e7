//! The files of the best start, and the table of all.

use super::ended::{StartEnd, best, folder_of};
use crate::app::batch::Batch;
use crate::app::error::CommandError;
use crate::app::kept::overwrite_check::make_folder;
use crate::app::request::{CommandInput, CommandOutput};
use crate::files::{Entries, printable};
use crate::math::significant;
use crate::report::atomic::{self, WriteError};
use crate::report::file_set::FileSet;
use crate::report::table::{aligned, cells_csv};
use crate::stop;
use std::fs;
use std::io::ErrorKind;
use std::path::Path;

/// Writes the files of the best start and the table of all, and returns a message.
pub(super) fn write(
    request: &CommandInput,
    batch: &Batch<'_>,
    ended: &[StartEnd],
    distinct: usize,
) -> Result<CommandOutput, CommandError> {
    let folder = &*request.folder();
    let origin = request.origin(true);
    let csv = cells_csv(&cells(ended), &origin);
    atomic::write(&folder.join("starts.csv"), csv.as_bytes())?;
    // Of the starts that found the best optimum the first, whatever the last digits say.
    let first = ended.iter().find(|one| one.optimum == Some(1));
    let best = first.or_else(|| best(ended).map(|i| &ended[i]));
    let solved = ended.iter().filter(|one| one.ended.is_solved).count();
    let seconds = batch.began.elapsed().as_secs_f64();
    let section = Entries::default()
        .with("command", &request.command)
        .with("run_in", batch.run_in)
        .with("count", ended.len())
        .with("solved", solved)
        .with("distinct_optima", distinct)
        // The start whose files these are.
        .with("best", best.map(|one| one.start.number))
        // Wall time of all of them.
        .with("seconds", seconds)
        .with_each("each", ended.iter().map(StartEnd::entries));
    if let Some(best) = best {
        copy(&folder_of(folder, best.start.number), folder, &section)?;
    }
    let is_stopped = stop::requested();
    let is_solved = solved > 0 && !is_stopped;
    let counts = format!(
        "{solved} of {} starts solved, {distinct} distinct {}, {seconds:.2} s, {}",
        ended.len(),
        if distinct == 1 { "optimum" } else { "optima" },
        folder.display()
    );
    let head = match best.and_then(StartEnd::objective) {
        Some(objective) if is_solved => {
            format!("solved: objective {}, {counts}", significant(objective, 8))
        }
        Some(objective) if solved > 0 => {
            format!(
                "interrupted: best objective {}, {counts}",
                significant(objective, 8)
            )
        }
        _ => format!("not solved: {counts}"),
    };
    let mut notes = best.map_or_else(Vec::new, |best| best.notes.clone());
    notes.extend(best.and_then(|best| lower(best, ended)));
    for one in ended {
        let told = one.ended.message.as_deref().map(printable);
        let number = one.start.number;
        notes.extend(told.map(|message| format!("start {number} failed: {message}")));
    }
    if is_stopped {
        notes.push("interrupted; the files hold the best start that had ended".to_owned());
    }
    Ok(CommandOutput {
        is_solved,
        result: format!("{head}\n{}", aligned(&rows(ended))),
        notes,
    })
}

/// A note where a start whose goal is not held has a lower objective than the best one.
fn lower(best: &StartEnd, ended: &[StartEnd]) -> Option<String> {
    let objective = best.objective().filter(|_| best.ended.is_solved)?;
    let others = ended
        .iter()
        .filter(|one| one.ended.is_solved && !one.is_held);
    let mut lower = others.filter_map(|one| Some((one.start.number, one.objective()?)));
    let (start, other) = lower.find(|(_, other)| best.is_held && *other < objective)?;
    Some(format!(
        "note: start {start} has the lower objective {}, but does not keep its goal or period",
        significant(other, 8)
    ))
}

pub(super) const COLUMNS: [&str; 7] = [
    "start",
    "guess",
    "status",
    "objective",
    "iterations",
    "seconds",
    "optimum",
];

/// The table as text for people.
pub(super) fn rows(ended: &[StartEnd]) -> Vec<Vec<String>> {
    let or_dash = |text: Option<String>| text.unwrap_or_else(|| "-".to_owned());
    let row = |one: &StartEnd| {
        vec![
            one.start.number.to_string(),
            one.start
                .seed
                .map_or("own".to_owned(), |seed| format!("seed {seed}")),
            one.ended.summary.status.replace('_', " "),
            or_dash(one.objective().map(|value| significant(value, 8))),
            or_dash(one.ended.summary.iterations.map(|count| count.to_string())),
            format!("{:.2}", one.ended.summary.seconds.total),
            or_dash(one.optimum.map(|number| number.to_string())),
        ]
    };
    let head = COLUMNS.map(str::to_owned).to_vec();
    [head].into_iter().chain(ended.iter().map(row)).collect()
}

/// The table as `starts.csv`; cells without a value are empty.
fn cells(ended: &[StartEnd]) -> Vec<Vec<String>> {
    let header = [
        "start",
        "seed",
        "status",
        "objective",
        "iterations",
        "seconds [s]",
        "optimum",
    ];
    let number = |value: Option<f64>| value.map_or_else(String::new, |v| format!("{v:?}"));
    let count = |value: Option<usize>| value.map_or_else(String::new, |v| v.to_string());
    let row = |one: &StartEnd| {
        vec![
            one.start.number.to_string(),
            one.start
                .seed
                .map_or_else(String::new, |seed| seed.to_string()),
            one.ended.summary.status.clone(),
            number(one.objective()),
            count(one.ended.summary.iterations),
            number(Some(one.ended.summary.seconds.total)),
            count(one.optimum),
        ]
    };
    let header = header.map(str::to_owned).to_vec();
    [header].into_iter().chain(ended.iter().map(row)).collect()
}

/// Copies the files of a start, its summary last and with the table of all.
pub(super) fn copy(from: &Path, to: &Path, section: &Entries) -> Result<(), WriteError> {
    let mut files = FileSet::in_folder(to);
    copy_folder(from, "", to, &mut files)?;
    let path = from.join("summary.json");
    let summary = match fs::read_to_string(&path) {
        Err(cause) if cause.kind() == ErrorKind::NotFound => "{}".to_owned(),
        read => read.map_err(WriteError::at(path))?,
    };
    files.add("summary.json", with_section(&summary, section).as_bytes())?;
    files.finish()
}

/// Copies all files of a folder but the summary, and those of its folders.
fn copy_folder(
    from: &Path,
    within: &str,
    to: &Path,
    files: &mut FileSet,
) -> Result<(), WriteError> {
    for entry in fs::read_dir(from).map_err(WriteError::at(from))? {
        let path = entry.map_err(WriteError::at(from))?.path();
        let Some(name) = path.file_name() else {
            continue;
        };
        let name = Path::new(within).join(name);
        if path.is_dir() {
            make_folder(&to.join(&name))?;
            copy_folder(&path, &name.to_string_lossy(), to, files)?;
        } else if name != Path::new("summary.json") {
            let bytes = fs::read(&path).map_err(WriteError::at(&path))?;
            files.add(name, &bytes)?;
        }
    }
    Ok(())
}

/// A summary with the section of the starts at its end.
pub(super) fn with_section(summary: &str, section: &Entries) -> String {
    let laid_out = section.laid_out();
    let indented = laid_out.trim_end().replace('\n', "\n  ");
    let open = summary.trim_end().trim_end_matches('}').trim_end();
    let comma = if open.ends_with('{') { "" } else { "," };
    format!("{open}{comma}\n  \"starts\": {indented}\n}}\n")
}
