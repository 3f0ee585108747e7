//! Comparison of one sparse matrix with its differences.
//!
//! Report of a check of derivatives by differences.

use crate::nlp::{Entries, Nlp};
use std::fmt;

/// Relative error above which an entry is taken for wrong.
pub const TOLERANCE: f64 = 1e-5;

/// Part of the row's size below which an entry is not measured by its own size.
const FLOOR: f64 = 1e-3;

/// A sparse matrix and its differences.
pub(super) struct Comparison {
    /// Analytic entries by column, duplicates summed, sorted by row.
    columns: Vec<Vec<(usize, f64)>>,
    /// t: size of the terms of the differenced value of each row.
    terms: Vec<f64>,
    /// r: greatest entry of each row.
    largest: Vec<f64>,
    /// Entries seen so far: those stored and those whose difference is not zero.
    pairs: Vec<Pair>,
}

struct Pair {
    row: usize,
    column: usize,
    place: EntryStatus,
    analytic: f64,
    difference: f64,
    /// Difference of a shorter step, where the first one is far away.
    again: Option<f64>,
}

/// Differences that are apart by this part of their distance from an entry agree against it.
const AGREE: f64 = 0.25;

impl Comparison {
    pub(super) fn new(places: &Entries, values: &[f64], terms: Vec<f64>, columns: usize) -> Self {
        let mut by_column = vec![Vec::<(usize, f64)>::new(); columns];
        for (row, col, value) in places.with(values) {
            assert!(
                row < terms.len(),
                "row {row} of the structure lies outside the matrix"
            );
            by_column[col].push((row, value));
        }
        for column in &mut by_column {
            column.sort_by_key(|&(row, _)| row);
            column.dedup_by(|duplicate, first| {
                let same = duplicate.0 == first.0;
                if same {
                    first.1 += duplicate.1;
                }
                same
            });
        }
        Self {
            columns: by_column,
            largest: vec![0.0; terms.len()],
            terms,
            pairs: Vec::new(),
        }
    }

    /// Adds |aᵢⱼ xⱼ| to the size of the terms of row i.
    pub(super) fn add_linear_terms(&mut self, x: &[f64]) {
        for (column, x) in self.columns.iter().zip(x) {
            for &(row, value) in column {
                self.terms[row] += (value * x).abs();
            }
        }
    }

    /// Returns true if a row changes of which no column of a group has an entry.
    pub(super) fn unread(&self, group: &[usize], changes: impl Fn(usize) -> bool) -> bool {
        let mut is_read = vec![false; self.terms.len()];
        let entries = group.iter().flat_map(|&column| &self.columns[column]);
        entries.for_each(|&(row, _)| is_read[row] = true);
        (0..is_read.len()).any(|row| !is_read[row] && changes(row))
    }

    /// Compares rows of a column with their differences: all that are meant, or those of them that have an entry.
    pub(super) fn compare(
        &mut self,
        column: usize,
        all: bool,
        is_meant: impl Fn(usize) -> bool,
        difference: impl Fn(usize) -> f64,
    ) {
        let mut stored = self.columns[column].iter().copied().peekable();
        let rows: Vec<usize> = match all {
            true => (0..self.terms.len()).collect(),
            false => stored.clone().map(|(row, _)| row).collect(),
        };
        for row in rows {
            let (place, analytic) = match stored.next_if(|&(stored_row, _)| stored_row == row) {
                Some((_, value)) => (EntryStatus::Stored, value),
                None => (EntryStatus::Missing, 0.0),
            };
            let difference = difference(row);
            if is_meant(row) && (place == EntryStatus::Stored || difference != 0.0) {
                self.largest[row] = self.largest[row].max(analytic.abs()).max(difference.abs());
                self.pairs.push(Pair {
                    row,
                    column,
                    place,
                    analytic,
                    difference,
                    again: None,
                });
            }
        }
    }

    /// Takes back the comparison of columns, ascending.
    pub(super) fn forget(&mut self, columns: &[usize]) {
        let is_kept = |pair: &Pair| columns.binary_search(&pair.column).is_err();
        self.pairs.retain(is_kept);
    }

    /// Columns with entries above the tolerance.
    pub(super) fn doubted(&self) -> Vec<usize> {
        let pairs = self.pairs.iter();
        let far = pairs.filter(|pair| self.error(pair) > TOLERANCE);
        far.map(|pair| pair.column).collect()
    }

    /// Compares the entries above the tolerance of a column with differences of another step.
    pub(super) fn compare_again(&mut self, column: usize, difference: impl Fn(usize) -> f64) {
        for index in 0..self.pairs.len() {
            let pair = &self.pairs[index];
            if pair.column == column && self.error(pair) > TOLERANCE {
                let again = difference(pair.row);
                self.pairs[index].again = Some(again);
            }
        }
    }

    /// Relative error of an entry, by the differences known so far: the smaller one, and none that counts where they are
    /// apart from each other as they are from the entry.
    fn error(&self, pair: &Pair) -> f64 {
        let size = self.largest[pair.row] + self.terms[pair.row];
        let first = relative_error(pair.analytic, pair.difference, size);
        let Some(again) = pair.again else {
            return first;
        };
        let nearest = first.min(relative_error(pair.analytic, again, size));
        let apart = relative_error(pair.difference, again, size);
        match apart > AGREE * nearest {
            true => nearest.min(TOLERANCE),
            false => nearest,
        }
    }

    /// The greatest error; entries whose error is above the tolerance are added to `wrong`.
    pub(super) fn judge(
        &self,
        matrix: Matrix,
        row_name: impl Fn(usize) -> String,
        nlp: &dyn Nlp,
        wrong: &mut Vec<WrongEntry>,
    ) -> f64 {
        let mut greatest = 0.0_f64;
        for pair in &self.pairs {
            let error = self.error(pair);
            let &Pair {
                row,
                column,
                place,
                analytic,
                difference,
                ..
            } = pair;
            greatest = greatest.max(error);
            if error > TOLERANCE {
                let (row, column) = match matrix {
                    Matrix::Hessian => (row.max(column), row.min(column)),
                    _ => (row, column),
                };
                let (row, column) = (row_name(row), nlp.variable_name(column));
                wrong.push(WrongEntry {
                    matrix,
                    row,
                    column,
                    place,
                    analytic,
                    difference,
                    error,
                });
            }
        }
        greatest
    }
}

/// |a − d| / max(|a|, |d|, `row`/1000); infinite if `a` is not a number.
fn relative_error(analytic: f64, difference: f64, row: f64) -> f64 {
    if analytic == difference {
        return 0.0;
    }
    let error =
        (analytic - difference).abs() / analytic.abs().max(difference.abs()).max(FLOOR * row);
    if error.is_nan() { f64::INFINITY } else { error }
}

/// A matrix of first or second derivatives.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Matrix {
    /// ∇f, one row.
    Gradient,
    /// ∇g.
    Jacobian,
    /// Hessian of the Lagrangian, lower triangle.
    Hessian,
}

/// Presence of an entry in the structure.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EntryStatus {
    /// The structure has the entry.
    Stored,
    /// The structure has no such entry, so that its analytic value is zero.
    Missing,
}

/// An entry whose analytic value and difference disagree.
#[derive(Clone, Debug, PartialEq)]
pub struct WrongEntry {
    /// The matrix.
    pub matrix: Matrix,
    /// Name of the row.
    pub row: String,
    /// The variable of the column.
    pub column: String,
    /// Presence of the entry in the structure.
    pub place: EntryStatus,
    /// Value given by the program.
    pub analytic: f64,
    /// Value from differences.
    pub difference: f64,
    /// Relative error.
    pub error: f64,
}

/// Findings of a check.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Report {
    /// Greatest relative error of the gradient.
    pub gradient: f64,
    /// Greatest relative error of the Jacobian.
    pub jacobian: f64,
    /// Greatest relative error of the Hessian.
    pub hessian: f64,
    /// Entries in error by more than [`TOLERANCE`](super::TOLERANCE), the worst first; at most twenty.
    pub wrong: Vec<WrongEntry>,
    /// Number of variables along which derivatives were compared.
    pub checked: usize,
    /// Number of variables for which no time was left.
    pub left: usize,
    /// Variables along which a value is NaN or ±∞ a small step away, so that nothing was checked there.
    pub unchecked: Vec<String>,
}

impl Report {
    /// True if every derivative was checked and none is wrong.
    #[must_use]
    pub const fn is_consistent(&self) -> bool {
        self.wrong.is_empty() && self.unchecked.is_empty() && self.left == 0
    }
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            gradient,
            jacobian,
            hessian,
            ..
        } = self;
        writeln!(
            f,
            "greatest relative errors: gradient {gradient:.1e}, Jacobian {jacobian:.1e}, Hessian {hessian:.1e}"
        )?;
        for WrongEntry {
            matrix,
            row,
            column,
            place,
            analytic,
            difference,
            error,
        } in &self.wrong
        {
            let value = match place {
                EntryStatus::Stored => format!("{analytic:.9e}"),
                EntryStatus::Missing => "no entry".to_owned(),
            };
            writeln!(
                f,
                "{matrix:?} ({row}, {column}): {value}, differences {difference:.9e}, error {error:.1e}"
            )?;
        }
        for column in &self.unchecked {
            writeln!(f, "{column}: not checked, a value does not exist nearby")?;
        }
        Ok(())
    }
}
