//! Report of a check of derivatives by differences.

use std::fmt;

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
