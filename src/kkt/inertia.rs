//! Signs of the eigenvalues of a symmetric matrix.

/// Numbers of negative eigenvalues, and of those that are zero to rounding.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Inertia {
    /// Negative eigenvalues.
    pub negative: usize,
    /// Eigenvalues that are zero to rounding: pivots without an entry in their column.
    pub zero: usize,
}
