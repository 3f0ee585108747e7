//! Compressed columns of a list of entries.

use crate::sparse::Symmetry;

/// Where the entries of a square matrix stand, column by column; of a symmetric matrix the lower triangle.
#[derive(Clone, Debug)]
pub(crate) struct Pattern {
    pub(crate) size: usize,
    pub(crate) symmetry: Symmetry,
    /// Slots of column `col` begin at `starts[col]`.
    pub(crate) starts: Vec<usize>,
    /// Row of each slot, ascending within a column.
    pub(crate) rows: Vec<usize>,
    /// (entry, slot), without the entries above the diagonal of a symmetric matrix.
    gather: Vec<(u32, u32)>,
    entries: usize,
}

impl Pattern {
    /// The pattern of `entries` in a matrix of `size` rows.
    ///
    /// # Panics
    /// An entry lies outside the matrix.
    pub(crate) fn new(size: usize, entries: &[(usize, usize)], symmetry: Symmetry) -> Self {
        assert!(
            entries.iter().all(|&(row, col)| row < size && col < size),
            "entries lie inside the matrix"
        );
        assert!(
            u32::try_from(entries.len()).is_ok(),
            "entries can be counted"
        );
        let kept = |&(row, col): &(usize, usize)| match symmetry {
            Symmetry::Symmetric => row >= col,
            Symmetry::Unsymmetric => true,
        };
        let mut order: Vec<usize> = (0..entries.len()).filter(|&k| kept(&entries[k])).collect();
        order.sort_unstable_by_key(|&k| (entries[k].1, entries[k].0, k));
        let (mut starts, mut rows) = (vec![0; size + 1], Vec::<usize>::new());
        let mut gather = Vec::with_capacity(order.len());
        let mut last = None;
        for k in order {
            let (row, col) = entries[k];
            if last.replace((row, col)) != Some((row, col)) {
                rows.push(row);
                starts[col + 1] += 1;
            }
            gather.push((k as u32, rows.len() as u32 - 1));
        }
        gather.sort_unstable();
        for col in 0..size {
            starts[col + 1] += starts[col];
        }
        Self {
            size,
            symmetry,
            starts,
            rows,
            gather,
            entries: entries.len(),
        }
    }

    /// Slots of a column.
    pub(crate) fn slots(&self, col: usize) -> std::ops::Range<usize> {
        self.starts[col]..self.starts[col + 1]
    }

    /// Adds up the values of entries by slot.
    pub(crate) fn gather(&self, entries: &[f64], values: &mut [f64]) {
        assert_eq!(entries.len(), self.entries, "one value per entry");
        values.fill(0.0);
        for &(entry, slot) in &self.gather {
            values[slot as usize] += entries[entry as usize];
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
