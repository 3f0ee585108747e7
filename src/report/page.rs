//! `report.html`: one page that needs nothing else, with the motion in space to turn and to play.

use serde_json::json;

use crate::report::lines::Series;
use crate::report::markup::escape;
use crate::report::plotly::{Figure, Trace, layout, library, rgb};
use crate::report::style::{self, Dash};
use crate::report::{Run, animation, joints, tracking, voltages};

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
    body.push_str(&section(heading, "motion", 720, &animation::figure(run)));
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
        (
            "Deviations",
            "deviations",
            tracking::label(run.tracked),
            tracking::curves(&run.trajectory.times, run.tracked),
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
        library()
    )
}

fn section(heading: &str, id: &str, height: usize, figure: &Figure) -> String {
    format!(
        "<h2>{heading}</h2>\n<div class=\"figure\" style=\"height:{height}px\">\n{}\n</div>\n",
        figure.html(id)
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

fn over_time(label: &str, series: &[Series]) -> Figure {
    let curve = |series: &Series| {
        let exists = |p: &&[f64; 2]| p.iter().all(|v| v.is_finite());
        let points = series.points.iter().filter(exists);
        let (x, y) = points.map(|p| (p[0], p[1])).unzip();
        let dash = match series.line {
            Some(Dash::Dashed) => "dash",
            _ => "solid",
        };
        Trace {
            look: json!({
                "type": "scatter",
                "name": escape(&series.name),
                "mode": "lines",
                "line": { "color": rgb(series.colour), "width": 2, "dash": dash },
            }),
            x,
            y,
            ..Trace::default()
        }
    };
    let axis = |title: &str| {
        json!({
            "title": { "text": title },
            "gridcolor": rgb(style::GRID),
            "linecolor": rgb(style::INK),
            "showline": true,
            "mirror": true,
            "zeroline": false,
        })
    };
    let axes = json!({ "xaxis": axis("time [s]"), "yaxis": axis(label), "hovermode": "closest" });
    Figure::new(series.iter().map(curve).collect(), layout(axes))
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
