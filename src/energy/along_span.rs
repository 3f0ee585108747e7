//! Virtual works of a damper along a span: blocks in a handful of vectors.

use crate::math::{Derivatives, Jet, Local, Matrix, Vector};
use nalgebra::SVector;

/// Virtual work `k(γ) α β` of the invariants α = r̄·ṙ, β = r̄·δr, γ = |r̄|²; arguments: δr, r̄, ṙ.
#[derive(Clone, Copy, Debug)]
pub struct AlongSpan {
    /// δr.
    d: Vector,
    /// r̄.
    r: Vector,
    /// ṙ.
    v: Vector,
    alpha: f64,
    beta: f64,
    /// k and its first two derivatives.
    k: [f64; 3],
}

impl AlongSpan {
    /// Makes the blocks from k with its first two derivatives by γ.
    #[inline(always)]
    pub(super) fn new(p: &SVector<f64, 9>, k: impl Fn(f64) -> [f64; 3]) -> Self {
        let part = |i: usize| Vector::new(p[i], p[i + 1], p[i + 2]);
        let (d, r, v) = (part(0), part(3), part(6));
        Self {
            d,
            r,
            v,
            alpha: r.dot(&v),
            beta: r.dot(&d),
            k: k(r.norm_squared()),
        }
    }

    /// Returns true if two of the arguments have mixed second derivatives: δr and ṙ do not couple with themselves.
    pub(super) fn couples(i: usize, j: usize) -> bool {
        i != j || i == 1
    }
}

/// The jet of any function of the same invariants of the first arguments δr, r̄, ṙ, where constants are arguments too.
pub(super) fn of_invariants<const M: usize, const ORDER: usize>(
    p: &SVector<f64, M>,
    w: &SVector<f64, M>,
    outer: impl FnOnce([Jet<3, ORDER>; 3]) -> Jet<3, ORDER>,
) -> Jet<M, ORDER> {
    let inner = [
        Jet::dot(3, 6, p, w),
        Jet::dot(3, 0, p, w),
        Jet::dot(3, 3, p, w),
    ];
    let values = SVector::from(inner.map(|j| j.value));
    let rates = SVector::from(inner.map(|j| j.value_w));
    let arguments = std::array::from_fn(|i| Jet::argument(i, &values, &rates));
    Jet::compose(&outer(arguments), &inner)
}

impl Local for AlongSpan {
    #[inline(always)]
    fn value(&self) -> f64 {
        self.k[0] * self.alpha * self.beta
    }

    #[inline(always)]
    fn plain<const NV: usize>(&self) -> impl Derivatives {
        *self
    }

    #[inline(always)]
    fn along<const NV: usize>(&self) -> impl Derivatives {
        *self
    }
}

impl Derivatives for AlongSpan {
    #[inline(always)]
    fn force(&self, i: usize) -> Vector {
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
            1 => v * (k[0] * beta) + d * (k[0] * alpha) + r * (2.0 * k[1] * alpha * beta),
            _ => r * (k[0] * beta),
        }
    }

    #[inline(always)]
    fn block(&self, i: usize, j: usize) -> Matrix {
        let Self {
            d,
            r,
            v,
            alpha,
            beta,
            k,
        } = *self;
        let one = Matrix::from_diagonal_element;
        // Of the force along the argument that the span is multiplied with, v for δr, δr for v.
        let with = |other: Vector, product: f64| {
            one(k[0] * product) + r * (other * k[0] + r * (2.0 * k[1] * product)).transpose()
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
                let half = v * (d * k[0]).transpose() + by_gamma * (r * 2.0).transpose();
                one(2.0 * k[1] * alpha * beta) + half + half.transpose()
            }
            _ => Matrix::zeros(),
        }
    }
}
