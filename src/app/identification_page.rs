//! `report.html` of an identification: constants with intervals, correlations, verdicts, measured against predicted, residuals.

use std::fmt::Write;

use crate::app::page::asked;
use crate::app::summary::Summary;
use crate::control::problem::Identification;
use crate::files::Loaded;
use crate::identify::{Identified, Series};
use crate::math::significant;
use crate::report::lines::{LinePlot, Mark, Series as Curve, over_time};
use crate::report::markup::escape;
use crate::report::origin::Origin;
use crate::report::style;

/// Look of the page.
const STYLE: &str = "body{font-family:Helvetica,Arial,'Liberation Sans',sans-serif;color:#22262b;max-width:60rem;margin:2rem auto;padding:0 1rem}\
table{border-collapse:collapse;margin:1rem 0;display:block;overflow-x:auto}th{overflow-wrap:anywhere}td,th{border:1px solid #e6e8eb;padding:.3rem .6rem;text-align:left}\
svg{max-width:100%;height:auto}pre{background:#f6f7f8;padding:1rem;overflow:auto}";

/// The page, with the texts of problem and scene.
pub(super) fn html(
    task: &Identification,
    loaded: &Loaded,
    found: &Identified,
    summary: &Summary,
    origin: &Origin,
) -> String {
    let mut page = String::new();
    let mut add = |text: String| {
        page.push_str(&text);
        page.push('\n');
    };
    add(format!(
        "<!DOCTYPE html><html lang=\"en\"><head><meta charset=\"utf-8\"><meta name=\"viewport\" content=\"width=device-width\">\
         <title>Identification</title><style>{STYLE}</style></head><body><h1>Identification</h1><p>{}</p>",
        escape(&summary.status.replace('_', " "))
    ));
    if let Some(identification) = &summary.identification {
        let lines: Vec<String> = identification.text().lines().map(escape).collect();
        add(list(&lines));
    }
    add(list(
        &summary
            .notes
            .lines()
            .map(|line| escape(&line))
            .collect::<Vec<_>>(),
    ));
    if let Some(table) = correlations(task, found) {
        add(table);
    }
    if let Some(table) = experiments(task, found) {
        add(table);
    }
    let held_out = found.held_out.iter().flat_map(|one| &one.series);
    for one in found.series.iter().chain(held_out) {
        add(section(task, one, origin));
    }
    let documents = [("Summary".to_owned(), summary.text())];
    for (name, text) in documents.iter().chain(&asked(loaded)) {
        add(format!(
            "<details><summary>{}</summary><pre>{}</pre></details>",
            escape(name),
            escape(text)
        ));
    }
    add(format!(
        "<p><small>{}</small></p></body></html>",
        escape(&origin.line())
    ));
    page
}

fn list(lines: &[String]) -> String {
    let items: String = lines
        .iter()
        .map(|line| format!("<li>{line}</li>"))
        .collect();
    match items.is_empty() {
        true => items,
        false => format!("<ul>{items}</ul>"),
    }
}

/// Correlations of the constants that have intervals; none of fewer than two.
fn correlations(task: &Identification, found: &Identified) -> Option<String> {
    let has = |&j: &usize| found.information.is_determined[j] && !found.fit.is_at_bound[j];
    let all: Vec<usize> = (0..task.parameters.len()).filter(has).collect();
    if all.len() < 2 {
        return None;
    }
    let name = |&j: &usize| format!("<th>{}</th>", escape(&task.parameters[j].name));
    let mut table = format!(
        "<h2>Correlation</h2><table><tr><th></th>{}</tr>",
        all.iter().map(name).collect::<String>()
    );
    for i in &all {
        let cell = |j: &usize| format!("<td>{:.3}</td>", found.information.correlation(*i, *j));
        let cells: String = all.iter().map(cell).collect();
        write!(table, "<tr>{}{cells}</tr>", name(i)).expect("writing to a string does not fail");
    }
    Some(table + "</table>")
}

/// The next experiments, the best one first.
fn experiments(task: &Identification, found: &Identified) -> Option<String> {
    let row = |one: &crate::identify::Experiment| {
        let error = |(j, value): (usize, &f64)| match one.information.is_determined[j] {
            true => {
                let variance = one.information.covariance[(j, j)];
                format!(
                    "<td>{} %</td>",
                    significant(100.0 * variance.sqrt() / value.abs(), 2)
                )
            }
            false => "<td>not determined</td>".to_owned(),
        };
        let values = found.fit.of_constants().iter().enumerate();
        let name = escape(&task.candidates[one.candidate].name);
        format!(
            "<tr><th>{name}</th>{}</tr>",
            values.map(error).collect::<String>()
        )
    };
    let rows: String = found.experiments.iter().map(row).collect();
    let names = task.parameters.iter();
    let names = names.map(|p| format!("<th>{}</th>", escape(&p.name)));
    (!rows.is_empty()).then(|| {
        format!(
            "<h2>Next experiment</h2><p>Standard errors that are left, the best experiment first.</p><table><tr><th></th>{}</tr>{rows}</table>",
            names.collect::<String>()
        )
    })
}

/// Measured against predicted, and residuals, of one quantity of one recording.
fn section(task: &Identification, one: &Series, origin: &Origin) -> String {
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
    let residuals = Curve::curve("", residuals, style::hue(1));
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
    format!(
        "<h2>{}: {}{held_out}</h2><div>{}</div><div>{}</div>",
        escape(&recording.name),
        escape(&channel.name),
        above.svg(origin),
        below.svg(origin)
    )
}
