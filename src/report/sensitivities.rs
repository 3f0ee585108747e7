//! Sensitivities of an optimum: table and figures.

use crate::dynamics::trajectory::Trajectory;
use crate::model::System;
use crate::model::system::InputKind;
use crate::report::axes::{Axis, Extent};
use crate::report::canvas::{self, Align, Canvas, Stroke, rectangle, text_width};
use crate::report::curves;
use crate::report::lines::{LinePlot, Series};
use crate::report::origin::Origin;
use crate::report::style::{self, Dash};
use crate::report::table::csv;
use crate::sensitivity::Sensitivity;

/// `sensitivities.csv`: one row per instant with the derivatives of inputs, in the interval that begins there, of joint coordinates and of places of
/// markers, each by each number in its unit of the International System.
pub fn table(
    system: &System,
    trajectory: &Trajectory,
    list: &[Sensitivity],
    origin: &Origin,
) -> String {
    let mut header = vec!["time [ms]".to_owned()];
    let mut columns: Vec<Vec<f64>> = vec![trajectory.times.clone()];
    let sources = system.sources();
    let joints = trajectory.coordinates(system);
    for one in list {
        let unit = one.varied.unit;
        let mut add = |name: &str, of: &str, values: Vec<f64>| {
            let by = match unit.symbol {
                "" => of.to_owned(),
                symbol => format!("{of}/({symbol})"),
            };
            header.push(format!("d {name} / d {} [{by}]", one.varied.name));
            columns.push(values.iter().map(|value| value / unit.factor).collect());
        };
        for (source, named) in sources
            .iter()
            .enumerate()
            .filter(|(_, source)| source.acts())
        {
            let by = one.voltages.iter().map(|row| row[source]);
            add(&named.name, named.kind.unit(), by.collect());
        }
        for (j, joint) in joints.iter().enumerate().filter(|_| !one.joints.is_empty()) {
            let by = one.joints.iter().map(|row| row[j]);
            add(&joint.name, joint.unit, by.collect());
        }
        for (m, marker) in system
            .markers
            .iter()
            .enumerate()
            .filter(|_| !one.markers.is_empty())
        {
            for (axis, letter) in ["x", "y", "z"].into_iter().enumerate() {
                let by = one.markers.iter().map(|row| row[m][axis]);
                add(&format!("{}_{letter}", marker.name), "mm", by.collect());
            }
        }
    }
    let cell = |column: &Vec<f64>, k: usize| column.get(k).copied().unwrap_or(f64::NAN);
    let rows =
        (0..trajectory.times.len()).map(|k| columns.iter().map(move |column| cell(column, k)));
    let line = format!(
        "{}; derivatives of an optimum, of inputs in the interval that begins at the time",
        origin.line()
    );
    csv(&line, header.into_iter(), rows)
}

/// A change of the objective with the tolerance of a number, to first order.
#[derive(Clone, Copy, Debug)]
struct Bar<'a> {
    name: &'a str,
    /// With the number greater by its tolerance.
    change: f64,
}

/// Bars of numbers that have a tolerance, the longest first.
fn bars(list: &[Sensitivity]) -> Vec<Bar<'_>> {
    let bar = |one: &'_ Sensitivity| one.varied.tolerance.map(|size| one.objective * size);
    let all = list.iter().filter_map(|one| Some((one, bar(one)?)));
    let mut bars: Vec<Bar<'_>> = all
        .map(|(one, change)| Bar {
            name: &one.varied.name,
            change,
        })
        .collect();
    bars.sort_by(|a, b| b.change.abs().total_cmp(&a.change.abs()));
    bars
}

/// Width of the frame, height of a bar and distance of bars in pt.
const FRAME: f64 = 360.0;
const BAR: f64 = 13.0;
const ROW: f64 = 21.0;
/// Margin above the frame for the legend, below it for the axis, and to its right.
const MARGIN: [f64; 3] = [30.0, 44.0, 24.0];

/// `sensitivities.svg`: changes of the objective with the tolerances, the greatest on top; none without tolerances.
pub fn svg(list: &[Sensitivity], origin: &Origin) -> Option<String> {
    let bars = bars(list);
    if bars.is_empty() {
        return None;
    }
    let names = bars
        .iter()
        .map(|bar| text_width(bar.name, style::TICK_SIZE));
    let left = names.fold(60.0, f64::max) + 16.0;
    let height = ROW * bars.len() as f64 + 6.0;
    let size = [left + FRAME + MARGIN[2], MARGIN[0] + height + MARGIN[1]];
    Some(canvas::svg(size, origin, |canvas| {
        draw(canvas, &bars, left, height);
    }))
}

fn draw(canvas: &Canvas<'_>, bars: &[Bar<'_>], left: f64, height: f64) {
    let axis = Axis::linear("change of the objective", Extent::Padded);
    let range = axis.range(bars.iter().flat_map(|bar| [-bar.change, bar.change]));
    let at = |value: f64| left + FRAME * (value - range[0]) / (range[1] - range[0]);
    let (top, bottom) = (MARGIN[0], MARGIN[0] + height);
    for (position, label) in axis.ticks(range, 5.0).major {
        let x = at(position);
        canvas.line(&[[x, top], [x, bottom]], Stroke::solid(style::GRID, 0.6));
        canvas.line(
            &[[x, bottom], [x, bottom + 4.0]],
            Stroke::solid(style::INK, 0.8),
        );
        let place = [x, bottom + 13.0];
        canvas.text(place, &label, style::TICK_SIZE, Align::Centre);
    }
    let sides = [
        (1.0, style::hue(0), "with the number + tolerance"),
        (-1.0, style::hue(1), "with the number − tolerance"),
    ];
    for (row, bar) in bars.iter().enumerate() {
        let middle = top + 3.0 + ROW * (row as f64 + 0.5);
        for (sign, colour, _) in sides {
            let [a, b] = [at(0.0), at(sign * bar.change)];
            let (up, down) = (middle - BAR / 2.0, middle + BAR / 2.0);
            canvas.fill(&rectangle([a, up], [b, down]), colour, 0.85);
        }
        let place = [left - 8.0, middle];
        canvas.text(place, bar.name, style::TICK_SIZE, Align::Right);
    }
    let corners = rectangle([left, top], [left + FRAME, bottom]);
    canvas.outline(&corners, Stroke::solid(style::INK, 0.8));
    canvas.line(
        &[[at(0.0), top], [at(0.0), bottom]],
        Stroke::solid(style::INK, 0.8),
    );
    let middle = [left + FRAME / 2.0, bottom + 31.0];
    canvas.text(middle, &axis.label, style::LABEL_SIZE, Align::Centre);
    let mut x = left;
    for (_, colour, words) in sides {
        let square = rectangle([x, 10.0], [x + 10.0, 20.0]);
        canvas.fill(&square, colour, 0.85);
        canvas.text([x + 15.0, 15.0], words, style::TICK_SIZE, Align::Left);
        x += 30.0 + text_width(words, style::TICK_SIZE);
    }
}

/// The same as a plot of the page.
pub fn bars_of_page(list: &[Sensitivity]) -> Option<LinePlot> {
    let bars = bars(list);
    let series = bars.iter().enumerate().map(|(row, bar)| {
        let y = -(row as f64) - 1.0;
        let points = vec![[-bar.change.abs(), y], [bar.change.abs(), y]];
        Series {
            width: 6.0,
            ..Series::curve(bar.name, points, style::hue(row))
        }
    });
    let plot = LinePlot::new(
        Axis::linear("change of the objective with ± tolerance", Extent::Padded),
        Axis::linear("", Extent::Padded),
        series.collect(),
    );
    (!bars.is_empty()).then_some(plot)
}

/// Voltages over time in s, each between two dashed lines: all numbers may be wrong by their tolerances at once; none without tolerances.
pub fn voltages(
    system: &System,
    trajectory: &Trajectory,
    list: &[Sensitivity],
) -> Option<LinePlot> {
    let kind = InputKind::Voltage;
    let (unit, size) = kind.counted();
    let change = |k: usize, source: usize| {
        let of = list.iter();
        let changes =
            of.filter_map(|one| Some(one.varied.tolerance? * one.voltages[k][source].abs()));
        changes.sum::<f64>()
    };
    let mut series = Vec::new();
    let sources = system.sources().into_iter().enumerate();
    for (i, source) in sources.filter(|(_, source)| source.takes_voltage) {
        let curve = |sign: f64| {
            let value = |k: usize, row: &[f64]| (row[i] + sign * change(k, i)) / size;
            curves::steps(trajectory, value)
        };
        let colour = style::hue(i);
        series.push(Series::curve(&source.name, curve(0.0), colour));
        for sign in [-1.0, 1.0] {
            series.push(Series {
                width: 0.7,
                ..Series::curve("", curve(sign), colour).dashed(Dash::Dashed)
            });
        }
    }
    let has_any = list.iter().any(|one| one.varied.tolerance.is_some()) && !series.is_empty();
    let label = format!("{} [{unit}], ± all tolerances", kind.name());
    has_any.then(|| LinePlot::over_time(label, series))
}
