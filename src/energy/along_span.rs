//! Virtual works of a damper along a span: blocks in a handful of vectors.

use crate::math::{Derivatives, Local, Number};
use nalgebra::{Matrix3, SVector, Vector3};

/// Virtual work `k(γ) α β` of the invariants α = r̄·ṙ, β = r̄·δr, γ = |r̄|²; arguments: δr, r̄, ṙ.
#[derive(Clone, Copy, Debug)]
pub struct AlongSpan<T = f64> {
    /// δr.
    d: Vector3<T>,
    /// r̄.
    r: Vector3<T>,
    /// ṙ.
    v: Vector3<T>,
    alpha: T,
    beta: T,
    /// k and its first two derivatives.
    k: [T; 3],
}

impl<T: Number> AlongSpan<T> {
    /// Makes the blocks from k with its first two derivatives by γ.
    #[inline(always)]
    pub(super) fn new(p: &SVector<T, 9>, k: impl Fn(T) -> [T; 3]) -> Self {
        let part = |i: usize| Vector3::new(p[i], p[i + 1], p[i + 2]);
        let (d, r, v) = (part(0), part(3), part(6));
        Self {
            d,
            r,
            v,
            alpha: r.dot(&v),
            beta: r.dot(&d),
            k: k(r.dot(&r)),
        }
    }

    /// Returns true if two of the arguments have mixed second derivatives: δr and ṙ do not couple with themselves.
    pub(super) fn couples(i: usize, j: usize) -> bool {
        i != j || i == 1
    }
}

impl<T: Number> Local<T> for AlongSpan<T> {
    #[inline(always)]
    fn value(&self) -> T {
        self.k[0] * self.alpha * self.beta
    }

    #[inline(always)]
    fn plain<const NV: usize>(&self) -> impl Derivatives<T> {
        *self
    }

    #[inline(always)]
    fn along<const NV: usize>(&self) -> impl Derivatives<T> {
        *self
    }
}

impl<T: Number> Derivatives<T> for AlongSpan<T> {
    #[inline(always)]
    fn force(&self, i: usize) -> Vector3<T> {
        let Self {
            d,
            r,
            v,
            alpha,
            beta,
            k,
        } = *self;
        match i {
            0 => r * (k[0] * alpha),
            1 => v * (k[0] * beta) + d * (k[0] * alpha) + r * (k[1].scaled(2.0) * alpha * beta),
            _ => r * (k[0] * beta),
        }
    }

    #[inline(always)]
    fn block(&self, i: usize, j: usize) -> Matrix3<T> {
        let Self {
            d,
            r,
            v,
            alpha,
            beta,
            k,
        } = *self;
        let one = Matrix3::from_diagonal_element;
        // Of the force along the argument that the span is multiplied with, v for δr, δr for v.
        let with = |other: Vector3<T>, product: T| {
            one(k[0] * product) + r * (other * k[0] + r * (k[1].scaled(2.0) * product)).transpose()
        };
        match (i, j) {
            (0, 1) => with(v, alpha),
            (1, 0) => with(v, alpha).transpose(),
            (2, 1) => with(d, beta),
            (1, 2) => with(d, beta).transpose(),
            (0, 2) | (2, 0) => r * (r * k[0]).transpose(),
            (1, 1) => {
                // Half of the terms; the others are their transposes.
                let by_gamma = (v * beta + d * alpha) * k[1] + r * (k[2] * alpha * beta);
                let half = v * (d * k[0]).transpose() + by_gamma * (r * T::of(2.0)).transpose();
                one(k[1].scaled(2.0) * alpha * beta) + half + half.transpose()
            }
            _ => Matrix3::zeros(),
        }
    }
}
