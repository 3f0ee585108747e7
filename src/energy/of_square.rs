//! Functions of the square of one vector, and of a voltage: blocks in a handful of numbers.

use crate::math::{Derivatives, Local, Matrix, Vector};
use nalgebra::SVector;

/// `u(I) + e(I) V²` with I = s |r|², arguments: r and, where there is one, V.
///
/// `∂/∂r = a r`, `∂²/∂r² = a 1 + b r rᵀ`, `∂²/∂r∂V = c r` with a = 2 s ∂/∂I, b = 4 s² ∂²/∂I², c = 2 s ∂²/∂I∂V.
#[derive(Clone, Copy, Debug)]
pub struct OfSquare {
    value: f64,
    at: At,
    rates: At,
}

#[derive(Clone, Copy, Debug)]
struct At {
    r: Vector,
    a: f64,
    b: f64,
    c: f64,
    row: f64,
    entry: f64,
}

struct SquareRates {
    at: At,
    rates: At,
}

impl OfSquare {
    /// Makes the blocks from u and e: value and three derivatives by I each.
    #[inline(always)]
    pub(super) fn new<const M: usize>(
        (p, w): (&SVector<f64, M>, &SVector<f64, M>),
        s: f64,
        u: impl Fn(f64) -> [f64; 4],
        e: impl Fn(f64) -> [f64; 4],
    ) -> Self {
        let vector = |x: &SVector<f64, M>| Vector::new(x[0], x[1], x[2]);
        let scalar = |x: &SVector<f64, M>| if M > 3 { x[3] } else { 0.0 };
        let ((r, v), (r_w, v_w)) = ((vector(p), scalar(p)), (vector(w), scalar(w)));
        let i = s * r.norm_squared();
        let (u, e) = (u(i), e(i));
        // Derivatives by I of the orders 0 to 3, and how they change with V.
        let by_i = |k: usize| u[k] + e[k] * v * v;
        let by_i_v = |k: usize| 2.0 * e[k] * v;
        let at = At {
            r,
            a: 2.0 * s * by_i(1),
            b: 4.0 * s * s * by_i(2),
            c: 2.0 * s * by_i_v(1),
            row: by_i_v(0),
            entry: 2.0 * e[0],
        };
        let i_w = 2.0 * s * r.dot(&r_w);
        let rate = |k: usize| by_i(k + 1) * i_w + by_i_v(k) * v_w;
        let rate_v = |k: usize| by_i_v(k + 1) * i_w + 2.0 * e[k] * v_w;
        let rates = At {
            r: r_w,
            a: 2.0 * s * rate(1),
            b: 4.0 * s * s * rate(2),
            c: 2.0 * s * rate_v(1),
            row: rate_v(0),
            entry: 2.0 * e[1] * i_w,
        };
        Self {
            value: by_i(0),
            at,
            rates,
        }
    }
}

impl Local for OfSquare {
    #[inline(always)]
    fn value(&self) -> f64 {
        self.value
    }

    #[inline(always)]
    fn plain<const NV: usize>(&self) -> impl Derivatives {
        self.at
    }

    #[inline(always)]
    fn along<const NV: usize>(&self) -> impl Derivatives {
        let Self { at, rates, .. } = *self;
        SquareRates { at, rates }
    }
}

impl Derivatives for At {
    #[inline(always)]
    fn force(&self, _: usize) -> Vector {
        self.r * self.a
    }

    #[inline(always)]
    fn row(&self, _: usize) -> f64 {
        self.row
    }

    #[inline(always)]
    fn block(&self, _: usize, _: usize) -> Matrix {
        Matrix::from_diagonal_element(self.a) + self.r * (self.r * self.b).transpose()
    }

    #[inline(always)]
    fn column(&self, _: usize, _: usize) -> Vector {
        self.r * self.c
    }

    #[inline(always)]
    fn entry(&self, _: usize, _: usize) -> f64 {
        self.entry
    }
}

impl Derivatives for SquareRates {
    #[inline(always)]
    fn force(&self, _: usize) -> Vector {
        self.at.r * self.rates.a + self.rates.r * self.at.a
    }

    #[inline(always)]
    fn row(&self, _: usize) -> f64 {
        self.rates.row
    }

    /// `ȧ 1 + ḃ r rᵀ + b (r ṙᵀ + ṙ rᵀ)` = `ȧ 1 + r qᵀ + q rᵀ` with q = b ṙ + ½ ḃ r.
    #[inline(always)]
    fn block(&self, _: usize, _: usize) -> Matrix {
        let (r, q) = (
            self.at.r,
            self.rates.r * self.at.b + self.at.r * (0.5 * self.rates.b),
        );
        let one = r * q.transpose();
        Matrix::from_diagonal_element(self.rates.a) + one + one.transpose()
    }

    #[inline(always)]
    fn column(&self, _: usize, _: usize) -> Vector {
        self.at.r * self.rates.c + self.rates.r * self.at.c
    }

    #[inline(always)]
    fn entry(&self, _: usize, _: usize) -> f64 {
        self.rates.entry
    }
}
