//! Compressed columns of a list of entries.

use crate::sparse::faer::{FaerLdlt, FaerLu};
use crate::sparse::mumps::Mumps;
use crate::sparse::{Factorisation, Singular, mumps};
use nalgebra::{DMatrix, DVectorViewMut, Dyn, LU};
use std::sync::Arc;

/// Positions of the entries of a square matrix, column by column; of a symmetric matrix the lower triangle.
#[derive(Clone, Debug)]
pub(crate) struct Pattern {
    pub(crate) size: usize,
    pub(crate) symmetry: Symmetry,
    /// Slots of column `col` begin at `starts[col]`.
    pub(crate) starts: Vec<usize>,
    /// Row of each slot, ascending within a column.
    pub(crate) rows: Vec<usize>,
    /// Slot of each entry; none of those above the diagonal of a symmetric matrix.
    slot_of: Vec<u32>,
}

/// In place of a slot.
const NONE: u32 = u32::MAX;

impl Pattern {
    /// The pattern of `entries` in a matrix of `size` rows.
    ///
    /// # Panics
    /// An entry lies outside the matrix.
    pub(crate) fn new(
        size: usize,
        entries: impl Iterator<Item = (usize, usize)> + Clone,
        symmetry: Symmetry,
    ) -> Self {
        let kept = |row: usize, col: usize| row >= col || symmetry == Symmetry::Unsymmetric;
        let (mut count, mut ends) = (0, vec![0; size + 1]);
        for (row, col) in entries.clone() {
            assert!(row < size && col < size, "entries lie inside the matrix");
            ends[col] += usize::from(kept(row, col));
            count += 1;
        }
        assert!(u32::try_from(count).is_ok(), "entries can be counted");
        let mut sum = 0;
        for end in &mut ends {
            (*end, sum) = (sum, sum + *end);
        }
        // (row, entry) by column: places before a column grow to those before the next.
        let mut listed = vec![(0, 0); sum];
        for (entry, (row, col)) in entries.enumerate() {
            if kept(row, col) {
                listed[ends[col]] = (row as u32, entry as u32);
                ends[col] += 1;
            }
        }
        let (mut starts, mut rows) = (vec![0; size + 1], Vec::with_capacity(sum));
        let mut slot_of = vec![NONE; count];
        let mut start = 0;
        for col in 0..size {
            let of_column = &mut listed[start..ends[col]];
            of_column.sort_unstable();
            let mut last = None;
            for &(row, entry) in &*of_column {
                if last.replace(row) != Some(row) {
                    rows.push(row as usize);
                }
                slot_of[entry as usize] = rows.len() as u32 - 1;
            }
            start = ends[col];
            starts[col + 1] = rows.len();
        }
        rows.shrink_to_fit();
        Self {
            size,
            symmetry,
            starts,
            rows,
            slot_of,
        }
    }

    /// Slots of a column.
    pub(crate) fn slots(&self, col: usize) -> std::ops::Range<usize> {
        self.starts[col]..self.starts[col + 1]
    }

    /// Adds up the values of entries by slot.
    pub(crate) fn gather(&self, entries: &[f64], values: &mut [f64]) {
        assert_eq!(entries.len(), self.slot_of.len(), "one value per entry");
        values.fill(0.0);
        for (value, &slot) in entries.iter().zip(&self.slot_of) {
            if slot != NONE {
                values[slot as usize] += value;
            }
        }
    }

    /// Calls `act` with row, column and value of every entry, of a symmetric matrix in both triangles.
    pub(crate) fn visit(&self, values: &[f64], mut act: impl FnMut(usize, usize, f64)) {
        for col in 0..self.size {
            for slot in self.slots(col) {
                let (row, value) = (self.rows[slot], values[slot]);
                act(row, col, value);
                if self.symmetry == Symmetry::Symmetric && row != col {
                    act(col, row, value);
                }
            }
        }
    }

    /// Multiplies each value by `rows[row] * cols[col]`.
    pub(crate) fn scale(&self, values: &mut [f64], rows: &[f64], cols: &[f64]) {
        for (col, factor) in cols.iter().enumerate() {
            for slot in self.slots(col) {
                values[slot] *= rows[self.rows[slot]] * factor;
            }
        }
    }
}

/// Up to this size a dense factorisation is faster.
pub const DENSE: usize = 48;
/// Above this size MUMPS is faster than LU of faer, with OpenBLAS, as `benches/factorisation.rs` measures.
const LARGE: usize = 15_000;

/// Method and library of a factorisation.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Backend {
    /// LU of nalgebra, for small matrices.
    Dense,
    /// LU of faer, or its LDLᵀ without exchanges where the matrix is symmetric: MUMPS gives the order of elimination, and takes
    /// over where the matrix turns out not to be quasi-definite.
    Faer,
    /// LU or LDLᵀ of MUMPS, one thread at a time.
    Mumps,
}

impl Backend {
    /// Returns the method that is fastest for this size.
    pub(super) fn of_size(size: usize, symmetry: Symmetry) -> Self {
        match symmetry {
            _ if size <= DENSE => Self::Dense,
            Symmetry::Unsymmetric if size > LARGE => Self::Mumps,
            _ => Self::Faer,
        }
    }

    pub(super) fn factorisation(self, pattern: &Arc<Pattern>) -> Box<dyn Factorisation> {
        match (self, pattern.symmetry) {
            (Self::Dense, _) => Box::new(Dense::new(pattern)),
            (Self::Faer, Symmetry::Symmetric) => {
                // Nested dissection leaves less fill than the minimum degree of faer.
                Box::new(FaerLdlt::new(pattern, mumps::order(pattern).as_deref()))
            }
            (Self::Faer, Symmetry::Unsymmetric) => Box::new(FaerLu::new(pattern)),
            (Self::Mumps, _) => Box::new(Mumps::new(pattern)),
        }
    }
}

/// A pivot below this in a matrix whose largest entries are near 1 counts as zero.
const TINY: f64 = 1e-14;

/// A dense factorisation.
#[derive(Debug)]
pub(crate) struct Dense {
    pattern: Pattern,
    values: Vec<f64>,
    factor: Option<LU<f64, Dyn, Dyn>>,
}

impl Dense {
    pub(crate) fn new(pattern: &Pattern) -> Self {
        Self {
            pattern: pattern.clone(),
            values: vec![0.0; pattern.rows.len()],
            factor: None,
        }
    }

    fn matrix(&self) -> DMatrix<f64> {
        let mut matrix = DMatrix::zeros(self.pattern.size, self.pattern.size);
        let set = |row, col, value| matrix[(row, col)] = value;
        self.pattern.visit(&self.values, set);
        matrix
    }
}

impl Factorisation for Dense {
    fn name(&self) -> &'static str {
        "dense LU"
    }

    fn factor(&mut self, values: &[f64]) -> Result<(), Singular> {
        self.values.copy_from_slice(values);
        let factor = LU::new(self.matrix());
        let pivots = factor.lu_internal();
        let zero = |&i: &usize| pivots[(i, i)].is_nan() || pivots[(i, i)].abs() < TINY;
        let singular = (0..self.pattern.size).find(zero);
        self.factor = Some(factor);
        singular.map_or(Ok(()), |column| Err(Singular { column }))
    }

    fn solve(&mut self, rhs: &mut [f64]) {
        let factor = self.factor.as_ref().expect("factor before solving");
        let size = rhs.len();
        factor.solve_mut(&mut DVectorViewMut::from_slice(rhs, size));
    }

    /// By the signs of eigenvalues: slow, and exact.
    fn negative_pivots(&self) -> Option<usize> {
        if self.pattern.size == 0 {
            return Some(0);
        }
        let count = || {
            let eigenvalues = self.matrix().symmetric_eigenvalues();
            eigenvalues.iter().filter(|&&value| value < 0.0).count()
        };
        (self.pattern.symmetry == Symmetry::Symmetric).then(count)
    }
}

/// Symmetry of a matrix: equal to its transpose or not.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Symmetry {
    /// A = Aᵀ; the method may be one for quasi-definite or indefinite matrices.
    Symmetric,
    /// Nothing is known.
    Unsymmetric,
}
