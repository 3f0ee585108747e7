//! LU of faer, supernodal: even small systems are dense enough for it.

use faer::dyn_stack::{MemBuffer, MemStack, StackReq};
use faer::sparse::SparseColMatRef;
use faer::sparse::linalg::lu::{self, LuRef, NumericLu, SymbolicLu};
use faer::sparse::linalg::{LuError, SupernodalThreshold};
use faer::{Conj, Par};

use crate::sparse::faer::{Memory, RIGHT, column, symbolic};
use crate::sparse::pattern::Pattern;
use crate::sparse::{Factorisation, Singular};

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
