//! Compressed columns of a list of entries.

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

/// Symmetry of a matrix: equal to its transpose or not.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Symmetry {
    /// A = Aᵀ; the method may be one for quasi-definite or indefinite matrices.
    Symmetric,
    /// Nothing is known.
    Unsymmetric,
}
