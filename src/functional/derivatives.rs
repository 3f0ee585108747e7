//! Derivatives of one element, read block by block, whatever its arity.

use crate::math::{Matrix, Vector};

/// First and second derivatives of a scalar E of one element by its arguments: vectors x_i, then scalars s.
///
/// Units are those of E, mJ for an energy, over mm for a vector, mm/ms for a rate, and the unit of a scalar (V for voltages and
/// potentials). What nobody asks for need not exist: after a gradient nobody asks for blocks, and of a pair of arguments that
/// does not couple neither. What belongs to scalars is zero for elements without any.
pub trait Derivatives {
    /// ∂E/∂x_i.
    fn force(&self, i: usize) -> Vector;

    /// ∂E/∂s.
    fn row(&self, _s: usize) -> f64 {
        0.0
    }

    /// ∂²E/∂x_i∂x_j; rows belong to i.
    fn block(&self, i: usize, j: usize) -> Matrix;

    /// ∂²E/∂x_i∂s.
    fn column(&self, _i: usize, _s: usize) -> Vector {
        Vector::zeros()
    }

    /// ∂²E/∂s∂t.
    fn entry(&self, _s: usize, _t: usize) -> f64 {
        0.0
    }
}
