//! Sensitivities of an optimum: table and figures.

use crate::dynamics::trajectory::Trajectory;
use crate::model::System;
use crate::model::system::InputKind;
use crate::report::axes::{Axis, Extent};
use crate::report::curves;
use crate::report::lines::{LinePlot, Series};
use crate::report::origin::Origin;
use crate::report::style::{self, Dash};
use crate::report::table::{TableColumn, csv};
use crate::sensitivity::Sensitivity;

/// `sensitivities.csv`: one row per instant with the derivatives of inputs, in the interval that begins there, of joint coordinates and of places of
/// markers, each by each number in its unit of the International System.
pub fn table(
    system: &System,
    trajectory: &Trajectory,
    list: &[Sensitivity],
    origin: &Origin,
) -> String {
    let mut columns = vec![TableColumn::new("time [ms]", &trajectory.times)];
    let sources = system.sources();
    let joints = trajectory.coordinates(system);
    for one in list {
        let unit = one.varied.unit;
        let mut add = |name: &str, of: &str, values: Vec<f64>| {
            let by = match unit.symbol {
                "" => of.to_owned(),
                symbol => format!("{of}/({symbol})"),
            };
            let heading = format!("d {name} / d {} [{by}]", one.varied.name);
            let values: Vec<f64> = values.iter().map(|value| value / unit.factor).collect();
            columns.push(TableColumn::new(heading, values));
        };
        let acting = sources.iter().enumerate();
        for (source, named) in acting.filter(|(_, source)| source.acts()) {
            let by = one.voltages.iter().map(|row| row[source]);
            add(&named.name, named.kind.unit(), by.collect());
        }
        for (j, joint) in joints.iter().enumerate().filter(|_| !one.joints.is_empty()) {
            let by = one.joints.iter().map(|row| row[j]);
            add(&joint.name, joint.unit, by.collect());
        }
        let markers = system.markers.iter().enumerate();
        for (m, marker) in markers.filter(|_| !one.markers.is_empty()) {
            for (axis, letter) in ["x", "y", "z"].into_iter().enumerate() {
                let by = one.markers.iter().map(|row| row[m][axis]);
                add(&format!("{}_{letter}", marker.name), "mm", by.collect());
            }
        }
    }
    let line = format!(
        "{}; derivatives of an optimum, of inputs in the interval that begins at the time",
        origin.line()
    );
    csv(&line, &columns)
}

/// Changes of the objective with the tolerances of numbers, to first order: bars under their names, the longest on top; none without tolerances.
pub fn bars(list: &[Sensitivity]) -> Option<LinePlot> {
    let change = |one: &Sensitivity| Some(one.objective * one.varied.tolerance?);
    let all = list.iter().filter_map(|one| Some((one, change(one)?)));
    let mut bars: Vec<(&Sensitivity, f64)> = all.collect();
    bars.sort_by(|a, b| b.1.abs().total_cmp(&a.1.abs()));
    let names: Vec<String> = bars.iter().map(|bar| bar.0.varied.name.clone()).collect();
    let side = |sign: f64, name: &str, hue: usize| {
        let bar = |(row, bar): (usize, &(&Sensitivity, f64))| {
            let height = (bars.len() - row) as f64;
            [[0.0, height], [sign * bar.1, height], [f64::NAN; 2]]
        };
        let points = bars.iter().enumerate().flat_map(bar);
        // The name of the first bar stands above it.
        let points = points.chain([[0.0, bars.len() as f64 + 0.7]]).collect();
        Series {
            width: BAR,
            ..Series::curve(name, points, style::hue(hue))
        }
    };
    // Every third point begins a bar.
    let labels = names
        .iter()
        .flat_map(|name| [name.clone(), String::new(), String::new()]);
    let series = vec![
        side(1.0, "with the number + tolerance", 0).labelled(labels.collect()),
        side(-1.0, "with the number − tolerance", 1),
    ];
    let plot = LinePlot {
        frame: [360.0, ROW * (bars.len() + 1) as f64],
        ..LinePlot::new(
            Axis::linear("change of the objective", Extent::Padded),
            Axis::linear("", Extent::Padded),
            series,
        )
    };
    (!bars.is_empty()).then_some(plot)
}

/// Width of a bar, and distance of bars, in pt.
const BAR: f64 = 7.0;
const ROW: f64 = 30.0;

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
