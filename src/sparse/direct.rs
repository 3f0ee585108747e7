//! LU factorisation of a square matrix whose pattern is laid down once.
//!
//! Rows are scaled by their largest entry before the factorisation, so that equations in different units meet one
//! criterion of singularity.

use faer::linalg::solvers::Solve;
use faer::prelude::Reborrow;
use faer::sparse::linalg::solvers::{Lu, SymbolicLu};
use faer::sparse::{Argsort, Pair, SparseColMat, SymbolicSparseColMat};
use nalgebra::{DMatrix, DVector, Dyn};
use thiserror::Error;

/// Up to this size a dense factorisation is faster.
const DENSE: usize = 48;
/// A pivot below this, relative to the largest entry of its row, counts as zero.
const TINY: f64 = 1e-14;
/// A known solution, with each unknown measured by its column, has to come back better than this.
const LOST: f64 = 1e-6;

/// The matrix is singular to working precision.
#[derive(Clone, Copy, Debug, Error, PartialEq, Eq)]
#[error("the matrix is singular: nothing determines unknown {column}")]
pub struct Singular {
    /// The column without a pivot.
    pub column: usize,
}

/// A direct solver for one pattern.
#[derive(Debug)]
pub struct Direct {
    size: usize,
    entries: Vec<(usize, usize)>,
    rows: Vec<f64>,
    scaled: Vec<f64>,
    kind: Kind,
}

#[derive(Debug)]
enum Kind {
    Dense(Option<nalgebra::LU<f64, Dyn, Dyn>>),
    Sparse(Box<Sparse>),
}

#[derive(Debug)]
struct Sparse {
    pattern: SymbolicSparseColMat<usize>,
    order: Argsort<usize>,
    symbolic: SymbolicLu<usize>,
    matrix: Option<SparseColMat<usize, f64>>,
    factor: Option<Lu<usize, f64>>,
}

impl Direct {
    /// A solver for matrices of `size` rows with these entries; entries listed twice add up.
    ///
    /// # Panics
    /// An entry lies outside the matrix.
    pub fn new(size: usize, entries: &[(usize, usize)]) -> Self {
        let kind = if size <= DENSE {
            Kind::Dense(None)
        } else {
            let pairs: Vec<Pair<usize, usize>> = entries
                .iter()
                .map(|&(row, col)| Pair { row, col })
                .collect();
            let (pattern, order) = SymbolicSparseColMat::try_new_from_indices(size, size, &pairs)
                .expect("entries lie inside the matrix");
            let symbolic =
                SymbolicLu::try_new(pattern.rb()).expect("memory for the symbolic factorisation");
            Kind::Sparse(Box::new(Sparse {
                pattern,
                order,
                symbolic,
                matrix: None,
                factor: None,
            }))
        };
        Self {
            size,
            entries: entries.to_vec(),
            rows: vec![1.0; size],
            scaled: vec![0.0; entries.len()],
            kind,
        }
    }

    /// Factorises the matrix with these values, one for each entry.
    ///
    /// # Errors
    /// The matrix is singular to working precision, or not finite.
    pub fn factor(&mut self, values: &[f64]) -> Result<(), Singular> {
        self.rows.fill(0.0);
        for (&(row, _), value) in self.entries.iter().zip(values) {
            self.rows[row] = self.rows[row].max(value.abs());
        }
        for scale in &mut self.rows {
            *scale = if *scale > 0.0 { 1.0 / *scale } else { 1.0 };
        }
        for ((scaled, value), &(row, _)) in self.scaled.iter_mut().zip(values).zip(&self.entries) {
            *scaled = value * self.rows[row];
        }
        match &mut self.kind {
            Kind::Dense(factor) => {
                let mut matrix = DMatrix::<f64>::zeros(self.size, self.size);
                for (&(row, col), value) in self.entries.iter().zip(&self.scaled) {
                    matrix[(row, col)] += value;
                }
                let lu = nalgebra::LU::new(matrix);
                let pivots = lu.lu_internal();
                let singular = (0..self.size)
                    .find(|&i| pivots[(i, i)].is_nan() || pivots[(i, i)].abs() < TINY);
                *factor = Some(lu);
                singular.map_or(Ok(()), |column| Err(Singular { column }))
            }
            Kind::Sparse(sparse) => sparse.factor(&self.scaled, self.size),
        }
    }

    /// Solves with the last factorisation, in place.
    ///
    /// # Panics
    /// No matrix has been factorised.
    pub fn solve(&self, rhs: &mut [f64]) {
        for (value, scale) in rhs.iter_mut().zip(&self.rows) {
            *value *= scale;
        }
        match &self.kind {
            Kind::Dense(factor) => {
                let mut x = DVector::from_column_slice(rhs);
                factor
                    .as_ref()
                    .expect("factor before solving")
                    .solve_mut(&mut x);
                rhs.copy_from_slice(x.as_slice());
            }
            Kind::Sparse(sparse) => sparse.solve(rhs),
        }
    }
}

impl Sparse {
    fn factor(&mut self, values: &[f64], size: usize) -> Result<(), Singular> {
        let matrix = SparseColMat::new_from_argsort(self.pattern.clone(), &self.order, values)
            .expect("memory for the matrix");
        let factor = Lu::try_new_with_symbolic(self.symbolic.clone(), matrix.rb());
        self.factor = factor.ok();
        self.matrix = Some(matrix);
        let largest = self.largest(size);
        let weakest = (0..size).min_by(|&a, &b| largest[a].total_cmp(&largest[b]));
        if self.factor.is_none() {
            let column = weakest.unwrap_or(0);
            return Err(Singular { column });
        }
        // What a singular factor does to a known solution: residuals stay small, the solution does not come back.
        let known = |col: usize| (1.0 + col as f64 / size as f64) / largest[col];
        let mut x: Vec<f64> = (0..size).map(known).collect();
        x = self.times(&x);
        self.solve(&mut x);
        let error = |col: usize| ((x[col] - known(col)) * largest[col]).abs();
        let lost = |col: &usize| error(*col).is_nan() || error(*col) > LOST;
        let worst = (0..size)
            .filter(lost)
            .max_by(|&a, &b| error(a).total_cmp(&error(b)));
        worst.map_or(Ok(()), |column| Err(Singular { column }))
    }

    fn times(&self, x: &[f64]) -> Vec<f64> {
        let matrix = self.matrix.as_ref().expect("a matrix has been set");
        let mut y = vec![0.0; x.len()];
        for (col, value) in x.iter().enumerate() {
            for (row, entry) in matrix.row_idx_of_col(col).zip(matrix.val_of_col(col)) {
                y[row] += entry * value;
            }
        }
        y
    }

    /// The largest entry of each column.
    fn largest(&self, size: usize) -> Vec<f64> {
        let matrix = self.matrix.as_ref().expect("a matrix has been set");
        let of_column = |col: usize| {
            let values = matrix.val_of_col(col).iter();
            values.fold(0.0_f64, |m, v| m.max(v.abs()))
        };
        (0..size).map(of_column).collect()
    }

    fn solve(&self, rhs: &mut [f64]) {
        let factor = self.factor.as_ref().expect("factor before solving");
        let size = rhs.len();
        let view = faer::MatMut::from_column_major_slice_mut(rhs, size, 1);
        factor.solve_in_place(view);
    }
}
