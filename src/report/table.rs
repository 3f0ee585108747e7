//! Tables: observations and voltages as CSV, and aligned text.

use std::fmt::Write;

use crate::dynamics::trajectory::{Observations, Trajectory};
use crate::model::system::System;
use crate::report::origin::Origin;

/// `trajectory.csv`: one row per instant, headers `name [unit]`; each number reads back identical, and where there is none
/// the cell is empty. Charges, which are observed in mC, are written in nC.
pub fn trajectory_csv(observations: &Observations, origin: &Origin) -> String {
    let columns = &observations.columns;
    let written = |unit: &'static str| match unit {
        "mC" => ("nC", 1e6),
        unit => (unit, 1.0),
    };
    let header = columns.iter().map(|c| match written(c.unit) {
        ("", _) => c.name.clone(),
        (unit, _) => format!("{} [{unit}]", c.name),
    });
    let rows = columns.iter().map(|c| c.values.len()).max().unwrap_or(0);
    let line = format!("{}; every column at the time of its row", origin.line());
    csv(
        &line,
        header,
        (0..rows).map(|k| {
            columns
                .iter()
                .map(move |c| written(c.unit).1 * c.values.get(k).copied().unwrap_or(f64::NAN))
        }),
    )
}

/// `controls.csv`: one row per interval with its start and end in ms and the voltage of each source in V.
pub fn controls_csv(trajectory: &Trajectory, system: &System, origin: &Origin) -> String {
    let header = ["start [ms]".to_owned(), "end [ms]".to_owned()]
        .into_iter()
        .chain(
            system
                .sources()
                .into_iter()
                .map(|s| format!("{} [V]", s.name)),
        );
    let ends = trajectory.times.windows(2);
    csv(
        &origin.line(),
        header,
        ends.zip(&trajectory.voltages)
            .map(|(ends, voltages)| ends.iter().chain(voltages).copied()),
    )
}

/// Rows of text cells as CSV under a line that names the origin; the first row is the header.
pub fn cells_csv(rows: &[Vec<String>], origin: &Origin) -> String {
    csv_under(&origin.line(), rows.iter().cloned())
}

/// Rows of cells as text in columns: the first to the left, the others to the right.
pub fn aligned(rows: &[Vec<String>]) -> String {
    let width = |column: usize| {
        let cells = rows.iter().filter_map(|row| row.get(column));
        cells.map(|cell| cell.chars().count()).max().unwrap_or(0)
    };
    let columns = rows.iter().map(Vec::len).max().unwrap_or(0);
    let widths: Vec<_> = (0..columns).map(width).collect();
    let mut text = String::new();
    for row in rows {
        let mut line = String::new();
        for (column, (cell, &width)) in row.iter().zip(&widths).enumerate() {
            match column {
                0 => write!(line, "{cell:<width$}"),
                _ => write!(line, "  {cell:>width$}"),
            }
            .expect("writing to a string does not fail");
        }
        text.push_str(line.trim_end());
        text.push('\n');
    }
    text
}

/// Rows of numbers as CSV under a line and a header; empty cells where there is no number.
pub(super) fn csv<R>(
    line: &str,
    header: impl Iterator<Item = String>,
    rows: impl Iterator<Item = R>,
) -> String
where
    R: Iterator<Item = f64>,
{
    // The shortest decimal that reads back as the same number.
    let cell = |value: f64| match value.is_finite() {
        true => format!("{value:?}"),
        false => String::new(),
    };
    let rows = rows.map(|row| row.map(cell).collect());
    csv_under(line, [header.collect()].into_iter().chain(rows))
}

/// Rows of cells, separated by commas, under a line of comment.
fn csv_under(line: &str, rows: impl Iterator<Item = Vec<String>>) -> String {
    let mut text = format!("# {line}\n");
    for row in rows {
        let cells: Vec<_> = row.iter().map(|cell| quoted(cell)).collect();
        text.push_str(&cells.join(","));
        text.push('\n');
    }
    text
}

/// A cell of RFC 4180: quoted where a comma, a quote or a line break asks for it.
fn quoted(cell: &str) -> String {
    if cell.contains([',', '"', '\n', '\r']) {
        format!("\"{}\"", cell.replace('"', "\"\""))
    } else {
        cell.to_owned()
    }
}
