//! Random matrices and their solutions by a dense method.

use Symmetry::Symmetric;
use nalgebra::DMatrix;
use proboscis::sparse::{Backend, Direct, Symmetry};

/// Numbers that look random: SplitMix64.
pub(crate) struct Random(pub(crate) u64);

impl Random {
    pub(crate) fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// Between −1 and 1.
    pub(crate) fn number(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / 2.0_f64.powi(52) - 1.0
    }

    pub(crate) fn below(&mut self, end: usize) -> usize {
        (self.bits() % end as u64) as usize
    }
}

/// A matrix by its entries.
#[derive(Clone)]
pub(crate) struct Matrix {
    pub(crate) size: usize,
    pub(crate) symmetry: Symmetry,
    pub(crate) entries: Vec<(usize, usize)>,
    pub(crate) values: Vec<f64>,
}

impl Matrix {
    /// About four entries per row beside the diagonal. Symmetric ones are indefinite, some with a zero on the diagonal.
    pub(crate) fn random(size: usize, symmetry: Symmetry, random: &mut Random) -> Self {
        let mut matrix = Self {
            size,
            symmetry,
            entries: Vec::new(),
            values: Vec::new(),
        };
        for row in 0..size {
            let diagonal = if row % 5 == 3 {
                0.0
            } else {
                2.0 * random.number()
            };
            matrix.push(row, row, diagonal);
            // A band keeps the matrix regular where the diagonal is zero.
            matrix.both(row, (row + 1) % size, 1.0 + 0.2 * random.number());
            matrix.both(row, random.below(size), 0.5 * random.number());
        }
        matrix
    }

    /// Positive in the first two of three unknowns, negative in the third.
    pub(crate) fn quasi_definite(size: usize, random: &mut Random) -> Self {
        let mut matrix = Self::random(size, Symmetric, random);
        let positive = |i: usize| i % 3 != 2;
        let kept = |&(row, col): &(usize, usize)| row != col;
        let mut of_row = vec![0.1; size];
        for (entry, value) in matrix.entries.iter().zip(&matrix.values) {
            if kept(entry) && positive(entry.0) == positive(entry.1) {
                of_row[entry.0] += value.abs();
            }
        }
        for (entry, value) in matrix.entries.iter().zip(&mut matrix.values) {
            *value = if kept(entry) { *value } else { 0.0 };
        }
        for (row, value) in of_row.into_iter().enumerate() {
            matrix.push(row, row, if positive(row) { value } else { -value });
        }
        matrix
    }

    pub(crate) fn push(&mut self, row: usize, col: usize, value: f64) {
        self.entries.push((row, col));
        self.values.push(value);
    }

    /// Adds an entry and, in a symmetric matrix, the one across the diagonal.
    pub(crate) fn both(&mut self, row: usize, col: usize, value: f64) {
        self.push(row, col, value);
        if self.symmetry == Symmetric {
            self.push(col, row, value);
        }
    }

    pub(crate) fn dense(&self) -> DMatrix<f64> {
        let mut dense = DMatrix::zeros(self.size, self.size);
        for (&(row, col), value) in self.entries.iter().zip(&self.values) {
            dense[(row, col)] += value;
        }
        dense
    }

    pub(crate) fn map(mut self, change: impl Fn(usize, usize, f64) -> f64) -> Self {
        for (&(row, col), value) in self.entries.iter().zip(&mut self.values) {
            *value = change(row, col, *value);
        }
        self
    }

    pub(crate) fn direct(&self, backend: Backend) -> Direct {
        Direct::with(self.size, &self.entries, self.symmetry, Some(backend))
    }
}

/// Greatest difference relative to the greatest number.
pub(crate) fn distance(a: &[f64], b: &[f64]) -> f64 {
    let norm = |v: &mut dyn Iterator<Item = f64>| v.fold(0.0_f64, |m, x| m.max(x.abs()));
    let size = norm(&mut b.iter().copied());
    assert!(size > 1e-3, "something to compare");
    norm(&mut a.iter().zip(b).map(|(a, b)| a - b)) / size
}
