//! faer: LU with row exchanges of unsymmetric and LDLᵀ without exchanges of symmetric matrices, by supernodes.
//!
//! A quasi-definite matrix has an LDLᵀ in every order. Others may break down or lose their digits; the check of a known
//! solution sees it.

use std::fmt;

use faer::dyn_stack::{MemBuffer, MemStack, StackReq};
use faer::linalg::cholesky::ldlt::factor::LdltRegularization;
use faer::perm::PermRef;
use faer::sparse::linalg::LuError;
use faer::sparse::linalg::cholesky::{
    self, LdltRef, SymbolicCholesky, SymbolicCholeskyRaw, SymmetricOrdering,
};
use faer::sparse::linalg::lu::{self, LuRef, NumericLu, SymbolicLu};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};
use faer::{Conj, MatMut, Par, Side};

use crate::sparse::mumps;
use crate::sparse::pattern::Pattern;
use crate::sparse::{Factorisation, Singular};

/// Columns of a right-hand side.
const RIGHT: usize = 1;

fn symbolic(pattern: &Pattern) -> SymbolicSparseColMatRef<'_, usize> {
    let Pattern {
        size, starts, rows, ..
    } = pattern;
    SymbolicSparseColMatRef::new_checked(*size, *size, starts, None, rows)
}

fn column(rhs: &mut [f64]) -> MatMut<'_, f64> {
    let size = rhs.len();
    MatMut::from_column_major_slice_mut(rhs, size, RIGHT)
}

/// Memory to work in.
struct Memory(MemBuffer);

impl fmt::Debug for Memory {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Memory({})", self.0.len())
    }
}

/// LU of faer.
#[derive(Debug)]
pub(crate) struct FaerLu {
    pattern: Pattern,
    symbolic: SymbolicLu<usize>,
    numeric: NumericLu<usize, f64>,
    memory: Memory,
}

impl FaerLu {
    pub(crate) fn new(pattern: &Pattern) -> Self {
        let analysed = lu::factorize_symbolic_lu(symbolic(pattern), Default::default())
            .expect("memory for the symbolic factorisation");
        let work = StackReq::any_of(&[
            analysed.factorize_numeric_lu_scratch::<f64>(Par::Seq, Default::default()),
            analysed.solve_in_place_scratch::<f64>(RIGHT, Par::Seq),
        ]);
        Self {
            pattern: pattern.clone(),
            symbolic: analysed,
            numeric: NumericLu::new(),
            memory: Memory(MemBuffer::new(work)),
        }
    }
}

impl Factorisation for FaerLu {
    fn name(&self) -> &'static str {
        "faer LU"
    }

    fn factor(&mut self, values: &[f64]) -> Result<(), Singular> {
        let matrix = SparseColMatRef::new(symbolic(&self.pattern), values);
        let factor = self.symbolic.factorize_numeric_lu(
            &mut self.numeric,
            matrix,
            Par::Seq,
            MemStack::new(&mut self.memory.0),
            Default::default(),
        );
        match factor {
            Ok(_) => Ok(()),
            Err(LuError::SymbolicSingular { index }) => Err(Singular {
                column: self.symbolic.col_perm().arrays().0[index],
            }),
            Err(LuError::Generic(error)) => panic!("LU of faer: {error:?}"),
        }
    }

    fn solve(&mut self, rhs: &mut [f64]) {
        LuRef::new_unchecked(&self.symbolic, &self.numeric).solve_in_place_with_conj(
            Conj::No,
            column(rhs),
            Par::Seq,
            MemStack::new(&mut self.memory.0),
        );
    }

    fn negative_pivots(&self) -> Option<usize> {
        None
    }
}

/// LDLᵀ of faer.
#[derive(Debug)]
pub(crate) struct FaerLdlt {
    pattern: Pattern,
    symbolic: SymbolicCholesky<usize>,
    values: Vec<f64>,
    memory: Memory,
}

impl FaerLdlt {
    pub(crate) fn new(pattern: &Pattern) -> Self {
        // Nested dissection leaves less fill than the minimum degree of faer.
        let order = mumps::order(pattern);
        let mut places = vec![0; order.len()];
        for (place, &row) in order.iter().enumerate() {
            places[row] = place;
        }
        let analysed = cholesky::factorize_symbolic_cholesky(
            symbolic(pattern),
            Side::Lower,
            SymmetricOrdering::Custom(PermRef::new_checked(&order, &places, order.len())),
            Default::default(),
        )
        .expect("memory for the symbolic factorisation");
        let work = StackReq::any_of(&[
            analysed.factorize_numeric_ldlt_scratch::<f64>(Par::Seq, Default::default()),
            analysed.solve_in_place_scratch::<f64>(RIGHT, Par::Seq),
        ]);
        Self {
            pattern: pattern.clone(),
            values: vec![0.0; analysed.len_val()],
            symbolic: analysed,
            memory: Memory(MemBuffer::new(work)),
        }
    }

    /// The diagonal of D, in the order of elimination.
    fn pivots(&self) -> Vec<f64> {
        match self.symbolic.raw() {
            SymbolicCholeskyRaw::Simplicial(simplicial) => {
                let starts = &simplicial.col_ptr()[..simplicial.ncols()];
                starts.iter().map(|&start| self.values[start]).collect()
            }
            SymbolicCholeskyRaw::Supernodal(supernodal) => {
                let factor = cholesky::supernodal::SupernodalLdltRef::new(supernodal, &self.values);
                let block = |s| {
                    let block = factor.supernode(s).val();
                    (0..block.ncols()).map(move |i| block[(i, i)])
                };
                (0..supernodal.n_supernodes()).flat_map(block).collect()
            }
        }
    }
}

impl Factorisation for FaerLdlt {
    fn name(&self) -> &'static str {
        "faer LDLᵀ"
    }

    fn factor(&mut self, values: &[f64]) -> Result<(), Singular> {
        let matrix = SparseColMatRef::new(symbolic(&self.pattern), values);
        let factor = self.symbolic.factorize_numeric_ldlt(
            &mut self.values,
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
        LdltRef::new(&self.symbolic, &self.values).solve_in_place_with_conj(
            Conj::No,
            column(rhs),
            Par::Seq,
            MemStack::new(&mut self.memory.0),
        );
    }

    fn negative_pivots(&self) -> Option<usize> {
        Some(self.pivots().iter().filter(|&&d| d < 0.0).count())
    }
}
