//! LU of faer, supernodal: even small systems are dense enough for it.
//!
//! LDLᵀ of faer.
//!
//! A quasi-definite matrix has an LDLᵀ in every order. Others may break down or lose their digits; the check of a known
//! solution sees it.

use crate::sparse::faer::{Memory, RIGHT, column, symbolic};
use crate::sparse::mumps::Mumps;
use crate::sparse::pattern::Pattern;
use crate::sparse::{Factorisation, Singular};
use faer::dyn_stack::{MemBuffer, MemStack, StackReq};
use faer::linalg::cholesky::ldlt::factor::LdltRegularization;
use faer::perm::PermRef;
use faer::sparse::SparseColMatRef;
use faer::sparse::linalg::cholesky::{
    self, LdltRef, SymbolicCholesky, SymbolicCholeskyRaw, SymmetricOrdering,
};
use faer::sparse::linalg::lu::{self, LuRef, NumericLu, SymbolicLu};
use faer::sparse::linalg::{LuError, SupernodalThreshold};
use faer::{Conj, Par, Side};
use std::sync::Arc;

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
        let params = lu::LuSymbolicParams {
            supernodal_flop_ratio_threshold: SupernodalThreshold::FORCE_SUPERNODAL,
            ..Default::default()
        };
        let analysed = lu::factorize_symbolic_lu(symbolic(pattern), params)
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
    pattern: Arc<Pattern>,
    symbolic: SymbolicCholesky<usize>,
    factors: Vec<f64>,
    memory: Memory,
}

impl FaerLdlt {
    /// For the rows in this order of elimination, or in one of minimum degree.
    pub(crate) fn new(pattern: &Arc<Pattern>, order: Option<&[usize]>) -> Self {
        let mut places = vec![0; order.map_or(0, <[usize]>::len)];
        for (place, &row) in order.into_iter().flatten().enumerate() {
            places[row] = place;
        }
        let order = order.map(|order| PermRef::new_checked(order, &places, order.len()));
        let symbolic = cholesky::factorize_symbolic_cholesky(
            symbolic(pattern),
            Side::Lower,
            order.map_or(SymmetricOrdering::Amd, SymmetricOrdering::Custom),
            Default::default(),
        );
        let symbolic = symbolic.expect("memory for the symbolic factorisation");
        let work = StackReq::any_of(&[
            symbolic.factorize_numeric_ldlt_scratch::<f64>(Par::Seq, Default::default()),
            symbolic.solve_in_place_scratch::<f64>(RIGHT, Par::Seq),
        ]);
        Self {
            pattern: Arc::clone(pattern),
            factors: vec![0.0; symbolic.len_val()],
            memory: Memory(MemBuffer::new(work)),
            symbolic,
        }
    }

    /// The diagonal of D, in the order of elimination.
    fn pivots(&self) -> Vec<f64> {
        match self.symbolic.raw() {
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

impl Factorisation for FaerLdlt {
    fn name(&self) -> &'static str {
        "faer LDLᵀ"
    }

    fn factor(&mut self, values: &[f64]) -> Result<(), Singular> {
        let matrix = SparseColMatRef::new(symbolic(&self.pattern), values);
        let factor = self.symbolic.factorize_numeric_ldlt(
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
        LdltRef::new(&self.symbolic, &self.factors).solve_in_place_with_conj(
            Conj::No,
            column(rhs),
            Par::Seq,
            MemStack::new(&mut self.memory.0),
        );
    }

    fn negative_pivots(&self) -> Option<usize> {
        let pivots = self.pivots();
        Some(pivots.iter().filter(|d| **d < 0.0).count())
    }

    /// With exchanges: the matrix may merely not be quasi-definite.
    fn more_robust(&self) -> Option<Box<dyn Factorisation>> {
        Some(Box::new(Mumps::new(&self.pattern)))
    }
}
