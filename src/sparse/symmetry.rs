//! Symmetry of a matrix, which chooses its factorisation.

/// Whether a matrix equals its transpose.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Symmetry {
    /// A = Aᵀ; the method may be one for quasi-definite or indefinite matrices.
    Symmetric,
    /// Nothing is known.
    Unsymmetric,
}
