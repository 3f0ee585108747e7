//! Vibrations about a state of rest as tables, figures, rows of the page and entries of `summary.json`.

use crate::app::request::CommandInput;
use crate::dynamics::observations;
use crate::dynamics::trajectory::{Column, Trajectory};
use crate::files::Entries;
use crate::math::significant;
use crate::model::system::InputKind;
use crate::report::atomic::WriteError;
use crate::report::axes::{Axis, Extent};
use crate::report::file_set::FileSet;
use crate::report::lines::{LinePlot, Series};
use crate::report::origin::Origin;
use crate::report::skins::Skins;
use crate::report::{PageContent, Run, style, table, write_page};
use crate::tasks::{FrequencyResponse, Vibrating};
use nalgebra::Complex;
use std::f64::consts::TAU;

/// Parts of the largest response of a figure below which a curve is left out.
const HARDLY: f64 = 1e-9;

/// A row of the table for each vibration: number, frequency in Hz, damping ratio, frequency with damping in Hz, time in s of the decay by 63 %, parts that
/// move.
fn table_of_modes(found: &Vibrating) -> Vec<Vec<String>> {
    let header = [
        "mode",
        "natural_frequency [Hz]",
        "damping_ratio",
        "damped_frequency [Hz]",
        "decay_time [s]",
        "moves",
    ];
    let modes = found.modes.vibrations.iter().enumerate();
    let rows = modes.map(|(k, mode)| {
        let (frequency, damping) = (1e3 * mode.frequency, mode.damping);
        let damped = 1e3 * mode.damped_frequency();
        let decay = 1.0 / (TAU * frequency * damping);
        let numbers = [frequency, damping, damped, decay].map(|value| format!("{value:?}"));
        let words = [(k + 1).to_string()].into_iter().chain(numbers);
        words.chain([mode.moves.clone()]).collect()
    });
    [header.map(str::to_owned).to_vec()]
        .into_iter()
        .chain(rows)
        .collect()
}

/// Columns of the table of the state: frequency and damping ratio of each, which a sweep has over what it varies.
pub(super) fn columns(found: &Vibrating) -> Vec<Column> {
    let modes = found.modes.vibrations.iter().enumerate();
    let columns = modes.flat_map(|(k, mode)| {
        let number = k + 1;
        let column = |name: &str, unit, value| Column {
            name: format!("mode{number}_{name}"),
            unit,
            values: vec![value],
        };
        [
            column("frequency", "Hz", 1e3 * mode.frequency),
            column("damping_ratio", "", mode.damping),
        ]
    });
    columns.collect()
}

/// Lines about the vibrations: `1   12.34 Hz   damping 3.2 %   joint1`.
fn lines(found: &Vibrating) -> Vec<Vec<String>> {
    let modes = found.modes.vibrations.iter().enumerate();
    let row = modes.map(|(k, mode)| {
        vec![
            format!("mode {}", k + 1),
            format!("{} Hz", significant(1e3 * mode.frequency, 5)),
            format!("damping {} %", significant(1e2 * mode.damping, 3)),
            mode.moves.clone(),
        ]
    });
    row.collect()
}

/// The vibrations as text.
pub(super) fn text(found: &Vibrating) -> String {
    let mut rows = lines(found);
    let moves: Vec<String> = rows.iter_mut().filter_map(Vec::pop).collect();
    let table = table::aligned(&rows);
    let each = table.lines().zip(&moves);
    each.map(|(line, moves)| format!("{line}  {moves}\n"))
        .collect()
}

/// Rows of the page.
pub(super) fn rows(found: &Vibrating) -> Vec<(String, String)> {
    let rows = lines(found).into_iter();
    rows.map(|row| (row[0].clone(), row[1..].join(", ")))
        .collect()
}

/// Their part of the summary.
pub(super) fn entries(found: &Vibrating) -> Entries {
    let modes = found.modes.vibrations.iter().map(|mode| {
        Entries::default()
            .with("frequency", 1e3 * mode.frequency)
            .with("damping_ratio", mode.damping)
            .with("moves", &mode.moves)
    });
    // In 1/s, of motions without vibration.
    let decay = found.modes.slowest_decay.map(|rate| 1e3 * rate);
    Entries::default()
        .with_each("modes", modes)
        .with_some("slowest_decay_rate", decay)
}

/// Amplitude and phase of a response in SI units for V, N or N m.
fn amplitude(response: &FrequencyResponse, kind: InputKind, output: usize) -> Vec<f64> {
    let (_, size) = kind.si();
    let length = match response.outputs[output].1 {
        "mm" => 1e-3,
        _ => 1.0,
    };
    let each = response.values.iter();
    each.map(|row| length * size * row[output].norm()).collect()
}

/// Phases in degrees, without jumps.
fn phases(response: &FrequencyResponse, output: usize) -> Vec<f64> {
    let mut last = 0.0;
    let each = response.values.iter().map(|row| row[output]);
    let phase = |value: Complex<f64>| {
        let phase: f64 = value.arg().to_degrees();
        last = phase + 360.0 * f64::round((last - phase) / 360.0);
        last
    };
    each.map(phase).collect()
}

/// A curve over the frequencies.
fn curve(response: &FrequencyResponse, output: usize, values: Vec<f64>) -> Series {
    let points = response.frequencies.iter().zip(values);
    let points = points.map(|(frequency, value)| [1e3 * frequency, value]);
    let (name, _) = &response.outputs[output];
    Series::curve(name, points.collect(), style::hue(output))
}

/// Files, titles and plots of a response: amplitudes of joints and of markers, and all phases.
fn plots(
    found: &Vibrating,
    response: &FrequencyResponse,
) -> Vec<(&'static str, &'static str, LinePlot)> {
    let kind = found.model.input_kind(response.source);
    let (unit, _) = kind.si();
    let largest = |output: usize| {
        amplitude(response, kind, output)
            .into_iter()
            .fold(0.0, f64::max)
    };
    let of = |inside: &str| -> Vec<usize> {
        let all = (0..response.outputs.len()).filter(|&o| response.outputs[o].1 == inside);
        let all: Vec<usize> = all.collect();
        let most = all.iter().map(|&o| largest(o)).fold(0.0, f64::max);
        all.into_iter()
            .filter(|&o| largest(o) > HARDLY * most)
            .collect()
    };
    let frequency = || Axis::log("frequency [Hz]");
    let (mut plots, mut shown) = (Vec::new(), Vec::new());
    let kinds = [
        (
            "rad",
            "frequency_response_angles.svg",
            "Amplitude of angles",
            "rad",
        ),
        ("mm", "frequency_response.svg", "Amplitude", "m"),
    ];
    for (inside, file, title, si) in kinds {
        let outputs = of(inside);
        if outputs.is_empty() {
            continue;
        }
        let curves = outputs
            .iter()
            .map(|&o| curve(response, o, amplitude(response, kind, o)));
        let axis = Axis::log(format!("amplitude [{si}/{unit}]"));
        plots.push((
            file,
            title,
            LinePlot::new(frequency(), axis, curves.collect()),
        ));
        shown.extend(outputs);
    }
    let curves = shown
        .into_iter()
        .map(|o| curve(response, o, phases(response, o)));
    let phase = Axis::linear("phase [°]", Extent::Padded);
    let plot = LinePlot::new(frequency(), phase, curves.collect());
    plots.push(("frequency_response_phase.svg", "Phase", plot));
    plots
}

/// Rows of `frequency_response.csv`.
fn table_of_response(found: &Vibrating, response: &FrequencyResponse) -> Vec<Vec<String>> {
    let kind = found.model.input_kind(response.source);
    let (unit, _) = kind.si();
    let outputs = 0..response.outputs.len();
    let mut header = vec!["frequency [Hz]".to_owned()];
    for (name, inside) in &response.outputs {
        let si = if *inside == "mm" { "m" } else { inside };
        header.push(format!("{name}_amplitude [{si}/{unit}]"));
        header.push(format!("{name}_phase [deg]"));
    }
    let columns = outputs.map(|o| [amplitude(response, kind, o), phases(response, o)]);
    let columns: Vec<[Vec<f64>; 2]> = columns.collect();
    let rows = response
        .frequencies
        .iter()
        .enumerate()
        .map(|(k, frequency)| {
            let of_outputs = columns
                .iter()
                .flat_map(|pair| pair.iter().map(|one| one[k]));
            let numbers = [1e3 * frequency].into_iter().chain(of_outputs);
            numbers.map(|value| format!("{value:?}")).collect()
        });
    [header].into_iter().chain(rows).collect()
}

/// Writes tables and figures, and the page with the shapes.
///
/// # Errors
/// A file cannot be written.
pub(super) fn write(
    found: &Vibrating,
    files: &mut FileSet,
    mut page: PageContent,
    request: &CommandInput,
    origin: &Origin,
) -> Result<(), WriteError> {
    let modes = table::cells_csv(&table_of_modes(found), origin);
    files.add("modes.csv", modes.as_bytes())?;
    if let Some(response) = &found.response {
        let rows = table::cells_csv(&table_of_response(found, response), origin);
        files.add("frequency_response.csv", rows.as_bytes())?;
        for (file, title, plot) in plots(found, response) {
            files.add(file, plot.svg(origin).as_bytes())?;
            page.plots.push((title.to_owned(), plot));
        }
    }
    if found.modes.vibrations.is_empty() {
        return Ok(());
    }
    let (model, shapes) = (&found.model, &found.shapes);
    let motion = Trajectory::from_discrete(model, shapes);
    let (skins, observed) = (Skins::new(model, shapes), observations(model, shapes));
    let run = Run {
        name: "modes",
        figures: request.figures,
        page: request.page.of(&page),
        ..Run::from_trajectory(&model.system, &motion, &skins, &observed, origin)
    };
    write_page(files, &run)
}
