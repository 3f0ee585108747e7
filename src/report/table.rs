//! Tables: observations and voltages as CSV, and aligned text.

use std::borrow::Cow;
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
    values: Cow<'a, [f64]>,
    /// Factor from the unit inside to the unit in the heading.
    factor: f64,
}

impl<'a> TableColumn<'a> {
    /// Numbers in the unit of the heading.
    pub(super) fn new(heading: impl Into<String>, values: impl Into<Cow<'a, [f64]>>) -> Self {
        Self {
            heading: heading.into(),
            values: values.into(),
            factor: 1.0,
        }
    }

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
        factor,
        ..TableColumn::new(heading, values)
    }
}

/// `trajectory.csv`: one row per instant, headers `name [unit]`; each number reads back identical, and where there is none
/// the cell is empty.
pub fn trajectory_csv(observations: &Observations, origin: &Origin) -> String {
    let line = format!("{}; every column at the time of its row", origin.line());
    csv(&line, &columns(observations))
}

/// The columns of `controls.csv`: start and end of an interval in ms, the voltage of each source in V, and each load.
pub fn controls<'a>(trajectory: &'a Trajectory, system: &System) -> Vec<TableColumn<'a>> {
    let (times, rows) = (&trajectory.times, &trajectory.voltages);
    let last = times.len() - 1;
    let ends = [("start [ms]", &times[..last]), ("end [ms]", &times[1..])];
    let ends = ends.map(|(heading, values)| TableColumn::new(heading, values));
    let inputs = system.sources().into_iter().enumerate();
    let inputs = inputs.map(|(i, source)| {
        let heading = format!("{} [{}]", source.name, source.kind.unit());
        let values: Vec<f64> = rows.iter().take(last).map(|row| row[i]).collect();
        TableColumn::new(heading, values)
    });
    ends.into_iter().chain(inputs).collect()
}

/// `controls.csv`: one row per interval.
pub fn controls_csv(trajectory: &Trajectory, system: &System, origin: &Origin) -> String {
    csv(&origin.line(), &controls(trajectory, system))
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
    let line = |row: &Vec<String>| {
        let cells = row.iter().zip(&widths).enumerate();
        let cells = cells.map(|(column, (cell, &width))| match column {
            0 => format!("{cell:<width$}"),
            _ => format!("  {cell:>width$}"),
        });
        cells.collect::<String>().trim_end().to_owned() + "\n"
    };
    rows.iter().map(line).collect()
}

/// Columns of numbers as CSV under a line and their headings; empty cells where there is no number.
pub(super) fn csv(line: &str, columns: &[TableColumn<'_>]) -> String {
    let headings = columns.iter().map(|column| column.heading.clone());
    let mut text = csv_under(line, [headings.collect()].into_iter());
    let lengths = columns.iter().map(|column| column.values.len());
    for k in 0..lengths.max().unwrap_or(0) {
        for (index, column) in columns.iter().enumerate() {
            if index > 0 {
                text.push(',');
            }
            let value = column.values.get(k).map(|value| column.factor * value);
            // The shortest decimal that reads back as the same number.
            if let Some(value) = value.filter(|value| value.is_finite()) {
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
