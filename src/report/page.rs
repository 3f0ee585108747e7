//! `report.html`: one page that needs nothing else, with the motion in space to turn and to play.

use plotly::color::Rgb;
use plotly::common::{DashType, Line, LineShape, Mode};
use plotly::layout::{Axis, HoverMode, Legend, Margin};
use plotly::{Layout, Plot, Scatter};

use crate::report::lines::Series;
use crate::report::style::{self, Colour, Dash};
use crate::report::{Run, animation, joints, voltages};

/// The page of a run.
pub fn html(run: &Run<'_>) -> String {
    let title = escape(run.title);
    let mut body = format!(
        "<h1>{title}</h1>\n<p class=\"system\">{}</p>\n",
        escape(&run.system.name)
    );
    body.push_str(&summary(run.summary));
    let moves = run.trajectory.times.len() > 1;
    let heading = if moves { "Motion" } else { "Configuration" };
    body.push_str(&section(heading, "motion", 720, &animation::plot(run)));
    let mut figures = vec![
        (
            "Voltages",
            "voltages",
            "voltage [kV]",
            voltages::curves(run.system, run.trajectory),
        ),
        (
            "Joints",
            "joints",
            joints::label(run.system, run.trajectory),
            joints::curves(run.system, run.trajectory),
        ),
        (
            "Energies",
            "energies",
            "energy [mJ]",
            joints::energies(run.trajectory, run.observations),
        ),
    ];
    figures.retain(|(_, _, _, series)| moves && !series.is_empty());
    for (heading, id, label, series) in &figures {
        body.push_str(&section(heading, id, 420, &over_time(label, series)));
    }
    body.push_str(&format!(
        "<footer>{}</footer>\n",
        escape(&run.origin.line())
    ));
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <title>{title}</title>\n<style>{}</style>\n{}\n</head>\n<body>\n{body}</body>\n</html>\n",
        sheet(),
        script()
    )
}

/// Text as HTML: what could be read as markup becomes an entity.
pub fn escape(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '"' => escaped.push_str("&quot;"),
            '\'' => escaped.push_str("&#39;"),
            _ => escaped.push(c),
        }
    }
    escaped
}

/// A colour as plotly takes it.
pub(crate) fn rgb(colour: Colour) -> Rgb {
    Rgb::new(colour.0, colour.1, colour.2)
}

/// The look of a plotly figure.
pub(crate) fn layout() -> Layout {
    Layout::new()
        .font(
            plotly::common::Font::new()
                .family(style::FONT)
                .size(13)
                .color(rgb(style::INK)),
        )
        .paper_background_color(rgb(style::PAPER))
        .plot_background_color(rgb(style::PAPER))
        .margin(Margin::new().left(70).right(20).top(20).bottom(55))
}

/// The plotly library itself, from the crate, so that the page works without a network.
fn script() -> String {
    const END: &str = "</script>";
    let sources = Plot::offline_js_sources();
    // The first script is plotly; formulas, which the second would set, do not occur.
    match sources.split_once(END) {
        Some((plotly, _)) => format!("{plotly}{END}"),
        None => sources,
    }
}

fn section(heading: &str, id: &str, height: usize, plot: &Plot) -> String {
    format!(
        "<h2>{heading}</h2>\n<div class=\"figure\" style=\"height:{height}px\">\n{}\n</div>\n",
        plot.to_inline_html(Some(id))
    )
}

fn summary(rows: &[(String, String)]) -> String {
    if rows.is_empty() {
        return String::new();
    }
    let rows: String = rows
        .iter()
        .map(|(key, value)| {
            format!(
                "<tr><th>{}</th><td>{}</td></tr>\n",
                escape(key),
                escape(value)
            )
        })
        .collect();
    format!("<table>\n{rows}</table>\n")
}

fn over_time(label: &str, series: &[Series]) -> Plot {
    let mut plot = Plot::new();
    for series in series {
        let (x, y) = series
            .points
            .iter()
            .filter(|p| p.iter().all(|v| v.is_finite()))
            .map(|p| (p[0], p[1]))
            .unzip();
        let dash = match series.line {
            Some(Dash::Dashed) => DashType::Dash,
            _ => DashType::Solid,
        };
        let line = Line::new()
            .color(rgb(series.colour))
            .width(2.0)
            .dash(dash)
            .shape(LineShape::Linear);
        plot.add_trace(
            Scatter::new(x, y)
                .name(escape(&series.name))
                .mode(Mode::Lines)
                .line(line),
        );
    }
    let axis = |title: &str| {
        Axis::new()
            .title(title.to_owned())
            .grid_color(rgb(style::GRID))
            .line_color(rgb(style::INK))
            .show_line(true)
            .mirror(true)
            .zero_line(false)
    };
    plot.set_layout(
        layout()
            .x_axis(axis("time [s]"))
            .y_axis(axis(label))
            .hover_mode(HoverMode::Closest)
            .legend(Legend::new()),
    );
    plot.set_configuration(
        plotly::Configuration::new()
            .responsive(true)
            .display_logo(false),
    );
    plot
}

fn sheet() -> String {
    let (ink, muted, grid) = (style::INK.hex(), style::MUTED.hex(), style::GRID.hex());
    format!(
        "body{{font-family:{};color:{ink};max-width:1000px;margin:2.5em auto;padding:0 1.5em}}\
         h1{{font-size:1.6em;margin:0}}h2{{font-size:1.1em;margin:2em 0 .4em}}\
         .system{{color:{muted};margin:.2em 0 1.6em}}\
         table{{border-collapse:collapse;font-size:.92em}}\
         th,td{{text-align:left;padding:.28em 1.6em .28em 0;border-bottom:1px solid {grid};vertical-align:top}}\
         th{{font-weight:normal;color:{muted}}}td{{font-variant-numeric:tabular-nums;overflow-wrap:anywhere}}\
         .figure{{width:100%}}\
         footer{{color:{muted};font-size:.75em;margin:3em 0 1em;overflow-wrap:anywhere}}",
        style::FONT
    )
}
