//! Inputs and joint coordinates that are functions of time, where times are unknowns: each value is an unknown with an equation of its own.
//!
//! ```text
//! v − S(c h) = 0,     c = k at instant k, k + ½ in interval k, N behind the end,
//! ```
//!
//! so that all other rows and the objective read values alone. Its derivatives are 1 by v, −c S′ by h, and −c² S″ by h twice; at a corner of S
//! those of the time after it.

use crate::control::numbering::{Column, Numbering, Row};
use crate::control::problem::Control;
use crate::math::Signal;
use crate::model::Model;

/// The rows behind the equations of motion.
#[derive(Clone, Debug, Default)]
pub(super) struct TimeRows {
    /// Each function once, with the entry of z or the scalar that it gives.
    functions: Vec<(Column, Signal)>,
    rows: Vec<TimeRow>,
}

/// The equation of one value.
#[derive(Clone, Copy, Debug)]
struct TimeRow {
    /// Column of v.
    column: usize,
    function: usize,
    /// Time over the interval length, c.
    lengths: f64,
}

impl TimeRows {
    /// Adds a row for each column that follows a function of time; the motion ends at instant `end`.
    pub(super) fn new(
        model: &Model,
        control: &Control,
        end: usize,
        unknowns: &mut Numbering,
    ) -> Self {
        let mut out = Self::default();
        for (number, &column) in unknowns.columns.iter().enumerate() {
            let Some(signal) = control.followed(model, column) else {
                continue;
            };
            let lengths = match column {
                Column::Instant { k, .. } => k as f64,
                Column::Interval { k, .. } if k < end => k as f64 + 0.5,
                _ => end as f64,
            };
            let of = first(column);
            let mut known = out.functions.iter();
            let function = known.position(|(one, _)| *one == of).unwrap_or_else(|| {
                out.functions.push((of, signal.clone()));
                out.functions.len() - 1
            });
            unknowns.rows.push(Row::Time {
                place: out.rows.len(),
                of: column,
            });
            out.rows.push(TimeRow {
                column: number,
                function,
                lengths,
            });
        }
        out
    }

    /// Number of rows.
    pub(super) fn len(&self) -> usize {
        self.rows.len()
    }

    /// Number of the column of a row.
    pub(super) fn column(&self, place: usize) -> usize {
        self.rows[place].column
    }

    /// Place of the row of a column.
    pub(super) fn place(&self, column: usize) -> Option<usize> {
        self.rows
            .binary_search_by_key(&column, |row| row.column)
            .ok()
    }

    /// The function of a row with its first two derivatives by the interval length h in ms.
    pub(super) fn derivatives(&self, place: usize, h: f64) -> [f64; 3] {
        let TimeRow {
            function, lengths, ..
        } = self.rows[place];
        let [value, rate, second] = self.functions[function].1.derivatives(lengths * h);
        [value, lengths * rate, lengths * lengths * second]
    }

    /// Columns with their values where the interval length is h.
    pub(super) fn values(&self, h: f64) -> impl Iterator<Item = (usize, f64)> {
        let value = move |place: usize| (self.column(place), self.derivatives(place, h)[0]);
        (0..self.len()).map(value)
    }
}

/// The column of the same variable at the first time.
fn first(column: Column) -> Column {
    match column {
        Column::Instant { i, .. } => Column::Instant { k: 0, i },
        Column::Interval { s, .. } => Column::Interval { k: 0, s },
        other => other,
    }
}
