//! `study.md`: the figures of a study and their meaning.

use crate::report::axes::Axis;
use crate::report::lines::{LinePlot, Mark, Series};
use crate::report::origin::Origin;
use crate::report::style;
use crate::study::compare::{Judged, common};
use crate::study::costs;
use crate::study::measure::StudyMeasure;
use crate::study::read::Study;
use crate::study::record::{command, machine};
use crate::study::schedule::Results;

/// The page; `figures` are the names of those written, by measure.
pub(super) fn markdown(
    results: &Results<'_>,
    judged: &[Judged],
    figures: &[Option<String>],
    conclusion: &str,
    table: &str,
    origin: &Origin,
) -> String {
    let study = results.study;
    let mut page = format!("# {}\n\n", study.title);
    let mut add = |text: String| {
        page.push_str(text.trim_end());
        page.push_str("\n\n");
    };
    if let Some(about) = &study.about {
        add(about.clone());
    }
    add(format!("**Conclusion.** {conclusion}"));
    add(how_it_was_run(results));
    add(format!(
        "## What accuracy costs\n\nSeconds are found between points by a straight line in the diagram; `*` marks the cheapest method and those that do not differ \
         clearly from it, `–` was not reached. Accuracies of places are relative to the path length of the markers.\n\n```text\n{}```",
        costs::cost_table(results, judged)
    ));
    for (judged, figure) in judged.iter().zip(figures) {
        add(section(study, judged, figure.as_deref()));
        if judged.measure == StudyMeasure::Path {
            let count = common(results).len();
            add(format!(
                "Compared at the {count} instants that all points have."
            ));
        }
    }
    add(format!("## All points\n\n```text\n{}```", table));
    add(
        "Seconds are the median of the timed runs. An error written with `<` is below the uncertainty of the limit itself: the number is that uncertainty and the distance from the limit together; `–` means not known. `table.csv` and `study.json` have the input, the quartiles and every run of each point."
            .to_owned(),
    );
    if let Some(failed) = failed(results) {
        add(failed);
    }
    add(again(results));
    add(format!("<sub>{}</sub>", origin.line().replace('<', "&lt;")));
    format!("{}\n", page.trim_end())
}

fn how_it_was_run(results: &Results<'_>) -> String {
    let points = results.methods.iter().flatten();
    let most = points.map(|done| done.seconds.len()).max().unwrap_or(0);
    let machine = machine();
    let processor = machine.processor.unwrap_or(machine.system);
    format!(
        "{most} timed runs of each point, round after round, on {processor}, cores: {}; reading files and measuring is not timed.",
        machine.cores
    )
}

fn section(study: &Study, judged: &Judged, figure: Option<&str>) -> String {
    let label = judged.measure.label();
    let mut capital = label.chars();
    let first = capital.next().map(|c| c.to_uppercase().to_string());
    let mut text = format!("## {}{}\n\n", first.unwrap_or_default(), capital.as_str());
    match figure {
        Some(name) => text.push_str(&format!("![{label} against seconds]({name})\n\n")),
        None => text.push_str("No error is above zero and above the uncertainty of its reference: nothing is drawn.\n\n"),
    }
    for (name, limit) in judged.limits(study) {
        let unit = judged.measure.unit().suffix().trim_matches([' ', '[', ']']);
        let value = match limit.value.as_slice() {
            [value] => format!(" {value:.12}"),
            [x, y, z] => format!(" ({x:.9}, {y:.9}, {z:.9}) {unit}"),
            _ => String::new(),
        };
        let known = limit.uncertainty;
        let known = known.map_or_else(String::new, |apart| format!(", ± {apart:.1e} {unit}"));
        let known = known.trim_end();
        text.push_str(&format!(
            "* Reference, {name}:{value}{known}, {}.\n",
            limit.how.words()
        ));
    }
    text
}

/// The points without an answer.
fn failed(results: &Results<'_>) -> Option<String> {
    let mut text = String::new();
    for (method, points) in results.each() {
        for done in points.iter().filter(|done| !done.first.is_solved) {
            let why = done.first.message.as_deref();
            let why = why.unwrap_or("it was not run to the end");
            let (label, status) = (&done.point.label, done.first.status.replace('_', " "));
            let (name, refined) = (&method.name, &method.refined);
            text.push_str(&format!("* {name}, {refined} {label}: {status} ({why})\n"));
        }
    }
    (!text.is_empty()).then(|| format!("## Points without an answer\n\n{text}"))
}

/// Returns the commands that run one point of each method alone.
fn again(results: &Results<'_>) -> String {
    let coarsest = results.methods.iter().filter_map(|points| points.first());
    let commands = coarsest.map(|done| command(results.study.asked, done.point) + "\n");
    let commands: String = commands.collect();
    format!(
        "## A point alone\n\nThe coarsest point of each method; the others differ in what is refined.\n\n```sh\n{commands}```"
    )
}

/// The diagram of one measure; none where no error is above zero.
///
/// The legend names the observed order; the first and the last point of a curve are labelled with the refined value.
pub(super) fn plot_diagram(results: &Results<'_>, judged: &Judged) -> Option<LinePlot> {
    let mut series = Vec::new();
    for (m, (method, points)) in results.each().enumerate() {
        let drawn = points.iter().enumerate().filter_map(|(k, done)| {
            let place = [done.median()?, judged.methods[m].known(k)?];
            Some((place, done.point.label.clone()))
        });
        let (places, mut labels): (Vec<_>, Vec<_>) = drawn.unzip();
        if places.is_empty() {
            continue;
        }
        let last = labels.len() - 1;
        for (k, label) in labels.iter_mut().enumerate() {
            if k != 0 && k != last {
                label.clear();
            }
        }
        let name = match judged.methods[m].order {
            Some(order) => format!("{}, order {order:.1}", method.name),
            None => method.name.clone(),
        };
        let curve = Series::curve(name, places, style::hue(m));
        series.push(curve.marked(Mark::Disc).labelled(labels));
    }
    if series.is_empty() {
        return None;
    }
    let unit = judged.measure.unit().suffix();
    Some(LinePlot {
        frame: [400.0, 290.0],
        ..LinePlot::new(
            Axis::log("median time of a solution [s]"),
            Axis::log(format!("{}{unit}", judged.measure.label())),
            series,
        )
    })
}
