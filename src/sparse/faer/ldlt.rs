//! LDLᵀ of faer.
//!
//! A quasi-definite matrix has an LDLᵀ in every order. Others may break down or lose their digits; the check of a known
//! solution sees it.

use std::sync::Arc;

use faer::dyn_stack::{MemBuffer, MemStack, StackReq};
use faer::linalg::cholesky::ldlt::factor::LdltRegularization;
use faer::perm::PermRef;
use faer::sparse::SparseColMatRef;
use faer::sparse::linalg::cholesky::{
    self, LdltRef, SymbolicCholesky, SymbolicCholeskyRaw, SymmetricOrdering,
};
use faer::{Conj, Par, Side};

use crate::sparse::faer::number::Number;
use crate::sparse::faer::{Memory, RIGHT, column, symbolic};
use crate::sparse::mumps::Mumps;
use crate::sparse::pattern::Pattern;
use crate::sparse::{Factorisation, Precision, Singular};

/// LDLᵀ of faer with factors of numbers `T`.
#[derive(Debug)]
pub(crate) struct FaerLdlt<T> {
    analysis: Arc<Analysis>,
    matrix: Vec<T>,
    factors: Vec<T>,
    rhs: Vec<T>,
    memory: Memory,
}

#[derive(Debug)]
struct Analysis {
    pattern: Arc<Pattern>,
    symbolic: SymbolicCholesky<usize>,
}

impl Analysis {
    /// For an order of elimination.
    fn new(pattern: &Arc<Pattern>, order: &[usize]) -> Self {
        let mut places = vec![0; order.len()];
        for (place, &row) in order.iter().enumerate() {
            places[row] = place;
        }
        let symbolic = cholesky::factorize_symbolic_cholesky(
            symbolic(pattern),
            Side::Lower,
            SymmetricOrdering::Custom(PermRef::new_checked(order, &places, order.len())),
            Default::default(),
        );
        Self {
            pattern: Arc::clone(pattern),
            symbolic: symbolic.expect("memory for the symbolic factorisation"),
        }
    }
}

impl<T: Number> FaerLdlt<T> {
    /// For the rows in an order of elimination.
    pub(crate) fn new(pattern: &Arc<Pattern>, order: &[usize]) -> Self {
        Self::of(Arc::new(Analysis::new(pattern, order)))
    }

    fn of(analysis: Arc<Analysis>) -> Self {
        let Analysis { pattern, symbolic } = &*analysis;
        let work = StackReq::any_of(&[
            symbolic.factorize_numeric_ldlt_scratch::<T>(Par::Seq, Default::default()),
            symbolic.solve_in_place_scratch::<T>(RIGHT, Par::Seq),
        ]);
        Self {
            matrix: vec![T::default(); pattern.rows.len()],
            factors: vec![T::default(); symbolic.len_val()],
            rhs: vec![T::default(); pattern.size],
            memory: Memory(MemBuffer::new(work)),
            analysis,
        }
    }

    /// The diagonal of D, in the order of elimination.
    fn pivots(&self) -> Vec<T> {
        match self.analysis.symbolic.raw() {
            SymbolicCholeskyRaw::Simplicial(simplicial) => {
                let starts = &simplicial.col_ptr()[..simplicial.ncols()];
                starts.iter().map(|&start| self.factors[start]).collect()
            }
            SymbolicCholeskyRaw::Supernodal(supernodal) => {
                let factor =
                    cholesky::supernodal::SupernodalLdltRef::new(supernodal, &self.factors);
                let block = |s| {
                    let block = factor.supernode(s).val();
                    (0..block.ncols()).map(move |i| block[(i, i)])
                };
                (0..supernodal.n_supernodes()).flat_map(block).collect()
            }
        }
    }
}

impl<T: Number> Factorisation for FaerLdlt<T> {
    fn name(&self) -> &'static str {
        T::LDLT
    }

    fn precision(&self) -> Precision {
        T::PRECISION
    }

    fn factor(&mut self, values: &[f64]) -> Result<(), Singular> {
        for (number, &value) in self.matrix.iter_mut().zip(values) {
            *number = T::near(value);
        }
        let matrix = SparseColMatRef::new(symbolic(&self.analysis.pattern), &self.matrix);
        let factor = self.analysis.symbolic.factorize_numeric_ldlt(
            &mut self.factors,
            matrix,
            Side::Lower,
            LdltRegularization::default(),
            Par::Seq,
            MemStack::new(&mut self.memory.0),
            Default::default(),
        );
        // A zero pivot tells no column: the matrix may be regular, and its order unlucky.
        factor.map(|_| ()).map_err(|_| Singular { column: 0 })
    }

    fn solve(&mut self, rhs: &mut [f64]) {
        // A power of two rounds nothing, and keeps numbers of little precision in their range.
        let peak = rhs
            .iter()
            .fold(0.0_f64, |peak, value| peak.max(value.abs()));
        let unit = match peak.is_normal() {
            true => peak.log2().round().exp2(),
            false => 1.0,
        };
        for (number, value) in self.rhs.iter_mut().zip(&*rhs) {
            *number = T::near(value / unit);
        }
        LdltRef::new(&self.analysis.symbolic, &self.factors).solve_in_place_with_conj(
            Conj::No,
            column(&mut self.rhs),
            Par::Seq,
            MemStack::new(&mut self.memory.0),
        );
        for (value, number) in rhs.iter_mut().zip(&self.rhs) {
            *value = number.value() * unit;
        }
    }

    fn negative_pivots(&self) -> Option<usize> {
        let pivots = self.pivots();
        Some(pivots.iter().filter(|d| d.value() < 0.0).count())
    }

    fn in_single_precision(&self) -> Option<Box<dyn Factorisation>> {
        Some(Box::new(FaerLdlt::<f32>::of(Arc::clone(&self.analysis))))
    }

    /// The same with more digits, and then with exchanges: the matrix may merely not be quasi-definite.
    fn more_robust(&self) -> Option<Box<dyn Factorisation>> {
        match T::PRECISION {
            Precision::Single => Some(Box::new(FaerLdlt::<f64>::of(Arc::clone(&self.analysis)))),
            Precision::Double => Some(Box::new(Mumps::new(&self.analysis.pattern))),
        }
    }
}
