//! Tables: observations and voltages as CSV, and aligned text.

use std::fmt::Write;

use crate::dynamics::trajectory::{Column, Observations, Trajectory};
use crate::model::system::System;
use crate::report::origin::Origin;

/// A column of numbers under its heading.
#[derive(Clone, Debug, PartialEq)]
pub struct TableColumn<'a> {
    /// Name and unit: `tip_x [mm]`.
    pub heading: String,
    /// Numbers as they are inside.
    values: &'a [f64],
    /// Factor from the unit inside to the unit in the heading.
    factor: f64,
}

impl TableColumn<'_> {
    /// The numbers in the unit of the heading.
    pub fn values(&self) -> impl ExactSizeIterator<Item = f64> + '_ {
        self.values.iter().map(|value| self.factor * value)
    }
}

/// The columns of `trajectory.csv`. Charges, which are observed in mC, are written in nC, rates in rad/s and m/s.
pub fn columns(observations: &Observations) -> Vec<TableColumn<'_>> {
    observations.columns.iter().map(headed).collect()
}

fn headed(Column { name, unit, values }: &Column) -> TableColumn<'_> {
    let (unit, factor) = match *unit {
        "mC" => ("nC", 1e6),
        "rad/ms" => ("rad/s", 1e3),
        "mm/ms" => ("m/s", 1.0),
        unit => (unit, 1.0),
    };
    let heading = match unit {
        "" => name.clone(),
        unit => format!("{name} [{unit}]"),
    };
    TableColumn {
        heading,
        values,
        factor,
    }
}

/// `trajectory.csv`: one row per instant, headers `name [unit]`; each number reads back identical, and where there is none
/// the cell is empty.
pub fn trajectory_csv(observations: &Observations, origin: &Origin) -> String {
    let columns = columns(observations);
    let rows = columns.iter().map(|c| c.values.len()).max().unwrap_or(0);
    let line = format!("{}; every column at the time of its row", origin.line());
    let cell = |column: &TableColumn<'_>, k: usize| {
        column.factor * column.values.get(k).copied().unwrap_or(f64::NAN)
    };
    csv(
        &line,
        columns.iter().map(|column| column.heading.clone()),
        (0..rows).map(|k| columns.iter().map(move |column| cell(column, k))),
    )
}

/// The headings of `controls.csv`: start and end of an interval in ms, the voltage of each source in V, and each load.
pub fn control_headings(system: &System) -> Vec<String> {
    let ends = ["start [ms]", "end [ms]"].map(str::to_owned);
    let sources = system.sources().into_iter();
    let inputs = sources.map(|source| format!("{} [{}]", source.name, source.kind.unit()));
    ends.into_iter().chain(inputs).collect()
}

/// `controls.csv`: one row per interval.
pub fn controls_csv(trajectory: &Trajectory, system: &System, origin: &Origin) -> String {
    let ends = trajectory.times.windows(2);
    csv(
        &origin.line(),
        control_headings(system).into_iter(),
        ends.zip(&trajectory.voltages)
            .map(|(ends, voltages)| ends.iter().chain(voltages).copied()),
    )
}

/// A cell of a table that is written to a file and shown as text: in full, and rounded.
#[derive(Clone, Debug)]
pub struct Cell {
    full: String,
    /// None of a column that is in the file alone.
    shown: Option<String>,
}

impl Cell {
    /// In full, and as it is shown.
    pub fn new(full: impl ToString, shown: impl ToString) -> Self {
        let (full, shown) = (full.to_string(), Some(shown.to_string()));
        Self { full, shown }
    }

    /// Shown as it is in the file.
    pub fn same(text: impl ToString) -> Self {
        Self::new(text.to_string(), text)
    }

    /// Of a column that is in the file alone.
    pub fn unshown(full: impl ToString) -> Self {
        let (full, shown) = (full.to_string(), None);
        Self { full, shown }
    }
}

/// Rows of the cells in full, and of those that are shown.
pub fn full_and_shown(rows: Vec<Vec<Cell>>) -> (Vec<Vec<String>>, Vec<Vec<String>>) {
    let rows = rows.into_iter().map(|row| {
        let (full, shown): (_, Vec<_>) = row.into_iter().map(|one| (one.full, one.shown)).unzip();
        (full, shown.into_iter().flatten().collect())
    });
    rows.unzip()
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
    let mut text = csv_under(line, [header.collect()].into_iter());
    for row in rows {
        for (column, value) in row.enumerate() {
            if column > 0 {
                text.push(',');
            }
            // The shortest decimal that reads back as the same number.
            if value.is_finite() {
                write!(text, "{value:?}").expect("writing to a string does not fail");
            }
        }
        text.push('\n');
    }
    text
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

/// A cell of RFC 4180: quoted where a comma, a quote or a line break asks for it, or where a spreadsheet would take it for a formula.
fn quoted(cell: &str) -> String {
    let is_formula = cell.starts_with(FORMULA) && cell.parse::<f64>().is_err();
    let mark = if is_formula { "'" } else { "" };
    if is_formula || cell.contains([',', '"', '\n', '\r']) {
        format!("\"{mark}{}\"", cell.replace('"', "\"\""))
    } else {
        cell.to_owned()
    }
}

/// Characters that a spreadsheet takes for the begin of a formula; an apostrophe before one marks the cell as text.
const FORMULA: [char; 6] = ['=', '+', '-', '@', '\t', '\r'];
