//! Work–precision studies: variants of one problem, timed and measured against the limit under refinement.
//!
//! - `read`: the study file and all its problems; `measure`: measures of them.
//! - `outcome`, `schedule`: one run, and all of them in rounds.
//! - `limit`, `compare`: observed orders and Richardson's limits; errors of all points.
//! - `costs`: costs of accuracies, and the conclusion in a sentence.
//! - `table`, `record`, `page`: output.

pub mod compare;
pub mod costs;
pub mod limit;
pub mod measure;
pub mod outcome;
mod page;
pub mod read;
mod record;
pub mod schedule;
pub mod table;

use std::time::Instant;

use crate::app::{CommandError, CommandInput, CommandOutput, make_folder};
use crate::report::table::{aligned, cells_csv, full_and_shown};
use crate::report::{PageContent, atomic, page::html};
use crate::study::compare::{Judged, judge, moved_marker};
use crate::study::costs::{conclusion, cost_table};
use crate::study::measure::StudyTask;
use crate::study::read::read_study;
use crate::study::schedule::{Results, bar, look, time};

/// Runs a study, with this number of timed runs of each point in place of that of the file, and writes its folder; one that
/// Ctrl-C ends early is kept as far as it went.
///
/// # Errors
/// The study or one of its problems is wrong, or the results cannot be written.
pub fn study(request: &CommandInput, runs: Option<usize>) -> Result<CommandOutput, CommandError> {
    let began = Instant::now();
    let study = read_study(&request.input)?;
    let folder = request.folder();
    make_folder(&folder)?;
    let runs = runs.unwrap_or(study.runs);
    let bar = bar(&study, runs, request.progress);
    let mut results = look(&study, &bar);
    if let Some((name, apart)) = moved_marker(&results) {
        bar.finish_and_clear();
        return Err(CommandError::problem(
            &request.input,
            "markers",
            format!(
                "{name:?} is {apart:.3} mm elsewhere in another scene, as the nearest node of a mesh; choose a place that is \
                 a node of each of them"
            ),
        ));
    }
    time(&mut results, runs, &bar);
    bar.finish_and_clear();
    let judged = judge(&results);
    let said = conclusion(&results, &judged);
    let table = write(request, runs, &results, &judged, &said)?;
    let [solved, all] = results.solved();
    let points = results.methods.iter().flatten();
    let failed = points.filter(|done| !done.first.is_solved);
    let failed = failed.filter_map(|done| {
        let why = done.first.message.as_ref()?;
        Some(format!("{}: {why}", done.point.set.join(", ")))
    });
    let interrupted = "interrupted; the files hold the results up to then".to_owned();
    let interrupted = results.is_interrupted.then_some(interrupted);
    Ok(CommandOutput {
        is_solved: solved > 0 && !results.is_interrupted,
        result: format!(
            "{table}{said}\n{solved} of {all} points solved, {:.1} s, {}",
            began.elapsed().as_secs_f64(),
            folder.display()
        ),
        notes: failed.chain(interrupted).collect(),
    })
}

/// Writes all files; the table to read.
fn write(
    request: &CommandInput,
    runs: usize,
    results: &Results<'_>,
    judged: &[Judged],
    said: &str,
) -> Result<String, CommandError> {
    let study = results.study;
    let folder = request.folder();
    let origin = request.origin(study.asked == StudyTask::Control);
    let put = |name: &str, text: &str| atomic::write(&folder.join(name), text.as_bytes());
    let (mut figures, mut plots) = (Vec::new(), Vec::new());
    for judged in judged {
        let name = format!("{}.svg", judged.measure);
        let plot = page::plot_diagram(results, judged);
        if let Some(plot) = &plot {
            put(&name, &plot.svg(&origin))?;
        }
        figures.push(plot.as_ref().map(|_| name));
        let title = judged.measure.label().to_owned();
        plots.extend(plot.map(|plot| (title, plot)));
    }
    let (full, shown) = full_and_shown(table::table(results, judged));
    let (points, costs) = (aligned(&shown), cost_table(results, judged));
    let text = format!("{points}\n{costs}");
    put("table.txt", &text)?;
    put("table.csv", &cells_csv(&full, &origin))?;
    let page = page::markdown(results, judged, &figures, said, &points, &origin);
    put("study.md", &page)?;
    let [solved, all] = results.solved();
    let said_of_all = PageContent {
        title: "Study".to_owned(),
        is_solved: solved > 0 && !results.is_interrupted,
        answer: format!("{solved} of {all} points solved"),
        notes: study
            .about
            .iter()
            .cloned()
            .chain([said.to_owned()])
            .collect(),
        rows: Vec::new(),
        plots,
        documents: vec![
            ("What accuracy costs".to_owned(), costs),
            ("All points".to_owned(), points),
        ],
    };
    put(
        "report.html",
        &html(&study.title, &[], &said_of_all, &origin),
    )?;
    let path = folder.join("study.json");
    record::write(&path, request, runs, results, judged, said)?;
    Ok(text)
}
