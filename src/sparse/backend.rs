//! Choice of the method of factorisation: by default the one that is fastest as a rule.

use crate::sparse::faer::{FaerLdlt, FaerLu};
use crate::sparse::mumps::Mumps;
use crate::sparse::pattern::{Pattern, Symmetry};
use crate::sparse::{Factorisation, Singular, mumps};
use nalgebra::{DMatrix, DVectorViewMut, Dyn, LU};
use std::sync::Arc;

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
