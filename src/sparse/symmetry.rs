//! Symmetry of a matrix, which chooses its factorisation.

/// Symmetry of a matrix: equal to its transpose or not.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Symmetry {
    /// A = Aᵀ; the method may be one for quasi-definite or indefinite matrices.
    Symmetric,
    /// Nothing is known.
    Unsymmetric,
}
