//! Derivatives of one element, read block by block, whatever its arity.

use crate::math::{Jet, Matrix, Number};
use nalgebra::{Matrix3, SMatrix, SVector, Vector3};

/// First and second derivatives of a scalar E of one element by its arguments: vectors x_i, then scalars s.
///
/// Units are those of E, mJ for an energy, over mm for a vector, mm/ms for a rate, and the unit of a scalar (V for voltages and
/// potentials). What nobody asks for need not exist: after a gradient nobody asks for blocks, and of a pair of arguments that
/// does not couple neither. What belongs to scalars is zero for elements without any.
pub trait Derivatives<T: Number = f64> {
    /// False if there are first derivatives alone: what asks for second ones is not compiled.
    const HAS_SECOND: bool = true;

    /// ∂E/∂x_i.
    fn force(&self, i: usize) -> Vector3<T>;

    /// ∂E/∂s.
    fn row(&self, _s: usize) -> T {
        T::zero()
    }

    /// ∂²E/∂x_i∂x_j; rows belong to i.
    fn block(&self, i: usize, j: usize) -> Matrix3<T>;

    /// ∂²E/∂x_i∂s.
    fn column(&self, _i: usize, _s: usize) -> Vector3<T> {
        Vector3::zeros()
    }

    /// ∂²E/∂s∂t.
    fn entry(&self, _s: usize, _t: usize) -> T {
        T::zero()
    }
}

/// First derivatives alone.
#[derive(Debug)]
pub struct Gradient<'a, D>(pub &'a D);

impl<D: Derivatives> Derivatives for Gradient<'_, D> {
    const HAS_SECOND: bool = false;

    #[inline(always)]
    fn force(&self, i: usize) -> Vector3<f64> {
        self.0.force(i)
    }

    #[inline(always)]
    fn row(&self, s: usize) -> f64 {
        self.0.row(s)
    }

    fn block(&self, i: usize, j: usize) -> Matrix3<f64> {
        self.0.block(i, j)
    }
}

/// A scalar of vectors and scalars at a point, with its derivatives along a direction.
pub trait Local<T: Number = f64> {
    /// Its value.
    fn value(&self) -> T;

    /// Its derivatives, by `NV` vectors first.
    fn plain<const NV: usize>(&self) -> impl Derivatives<T>;

    /// The rates of its derivatives along the direction. Nobody asks for those of a virtual work: at δx = w it is the contraction
    /// itself.
    fn along<const NV: usize>(&self) -> impl Derivatives<T>;
}

/// Gradient and Hessian by M arguments, NV vectors first.
struct OfJet<'a, T, const M: usize, const NV: usize>(&'a SVector<T, M>, &'a SMatrix<T, M, M>);

impl<T: Number, const M: usize, const NV: usize> Derivatives<T> for OfJet<'_, T, M, NV> {
    #[inline(always)]
    fn force(&self, i: usize) -> Vector3<T> {
        self.0.fixed_rows::<3>(3 * i).into()
    }

    #[inline(always)]
    fn row(&self, s: usize) -> T {
        self.0[3 * NV + s]
    }

    #[inline(always)]
    fn block(&self, i: usize, j: usize) -> Matrix3<T> {
        self.1.fixed_view::<3, 3>(3 * i, 3 * j).into()
    }

    #[inline(always)]
    fn column(&self, i: usize, s: usize) -> Vector3<T> {
        self.1.fixed_view::<3, 1>(3 * i, 3 * NV + s).into()
    }

    #[inline(always)]
    fn entry(&self, s: usize, t: usize) -> T {
        self.1[(3 * NV + s, 3 * NV + t)]
    }
}

impl<T: Number, const M: usize, const ORDER: usize> Local<T> for Jet<M, ORDER, T> {
    #[inline(always)]
    fn value(&self) -> T {
        self.value
    }

    #[inline(always)]
    fn plain<const NV: usize>(&self) -> impl Derivatives<T> {
        OfJet::<T, M, NV>(&self.gradient, &self.hessian)
    }

    #[inline(always)]
    fn along<const NV: usize>(&self) -> impl Derivatives<T> {
        OfJet::<T, M, NV>(&self.gradient_w, &self.hessian_w)
    }
}

/// A bound of the largest eigenvalue of a symmetric matrix, which two equal lower ones attain: its mean and √(2/3) times the norm of the rest.
pub fn largest_eigenvalue_bound(a: &Matrix) -> f64 {
    let mean = a.trace() / 3.0;
    let rest = a - Matrix::from_diagonal_element(mean);
    mean + (2.0_f64 / 3.0).sqrt() * rest.norm()
}

#[cfg(test)]
#[path = "../../tests/units/math/derivatives.rs"]
mod tests;
