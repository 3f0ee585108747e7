//! Derivatives of one element, read block by block, whatever its arity.

use crate::math::{Jet, Matrix, Vector};
use nalgebra::{SMatrix, SVector};

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

/// A scalar of vectors and scalars at a point, with its derivatives along a direction.
pub trait Local {
    /// Its value.
    fn value(&self) -> f64;

    /// Its derivatives, by `NV` vectors first.
    fn plain<const NV: usize>(&self) -> impl Derivatives;

    /// The rates of its derivatives along the direction. Nobody asks for those of a virtual work: at δx = w it is the contraction
    /// itself.
    fn along<const NV: usize>(&self) -> impl Derivatives;
}

/// Gradient and Hessian by M arguments, NV vectors first.
struct OfJet<'a, const M: usize, const NV: usize>(&'a SVector<f64, M>, &'a SMatrix<f64, M, M>);

impl<const M: usize, const NV: usize> Derivatives for OfJet<'_, M, NV> {
    #[inline(always)]
    fn force(&self, i: usize) -> Vector {
        self.0.fixed_rows::<3>(3 * i).into()
    }

    #[inline(always)]
    fn row(&self, s: usize) -> f64 {
        self.0[3 * NV + s]
    }

    #[inline(always)]
    fn block(&self, i: usize, j: usize) -> Matrix {
        self.1.fixed_view::<3, 3>(3 * i, 3 * j).into()
    }

    #[inline(always)]
    fn column(&self, i: usize, s: usize) -> Vector {
        self.1.fixed_view::<3, 1>(3 * i, 3 * NV + s).into()
    }

    #[inline(always)]
    fn entry(&self, s: usize, t: usize) -> f64 {
        self.1[(3 * NV + s, 3 * NV + t)]
    }
}

impl<const M: usize, const ORDER: usize> Local for Jet<M, ORDER> {
    #[inline(always)]
    fn value(&self) -> f64 {
        self.value
    }

    #[inline(always)]
    fn plain<const NV: usize>(&self) -> impl Derivatives {
        OfJet::<M, NV>(&self.gradient, &self.hessian)
    }

    #[inline(always)]
    fn along<const NV: usize>(&self) -> impl Derivatives {
        OfJet::<M, NV>(&self.gradient_w, &self.hessian_w)
    }
}
