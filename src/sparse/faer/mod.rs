//! faer: LU with row exchanges of unsymmetric and LDLᵀ without exchanges of symmetric matrices, by supernodes.

mod factors;

use std::fmt;

use faer::MatMut;
use faer::dyn_stack::MemBuffer;
use faer::sparse::SymbolicSparseColMatRef;

use crate::sparse::pattern::Pattern;

pub(crate) use factors::{FaerLdlt, FaerLu};

/// Columns of a right-hand side.
const RIGHT: usize = 1;

fn symbolic(pattern: &Pattern) -> SymbolicSparseColMatRef<'_, usize> {
    let Pattern {
        size, starts, rows, ..
    } = pattern;
    SymbolicSparseColMatRef::new_checked(*size, *size, starts, None, rows)
}

/// A right-hand side as a matrix.
pub(crate) fn column<T>(rhs: &mut [T]) -> MatMut<'_, T> {
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
