//! Choice of the method of factorisation: by default the one that is fastest as a rule.

use std::sync::Arc;

use crate::sparse::dense::Dense;
use crate::sparse::faer::{FaerLdlt, FaerLu};
use crate::sparse::mumps::{self, Mumps};
use crate::sparse::pattern::Pattern;
use crate::sparse::{Factorisation, Symmetry};

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
