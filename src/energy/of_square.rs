//! Functions of the square of one vector, and of a voltage: blocks in a handful of numbers.

use crate::math::{Derivatives, Local, Number};
use nalgebra::{Matrix3, SVector, Vector3};

/// `u(I) + e(I) V²` with I = s |r|², arguments: r and, where there is one, V.
///
/// `∂/∂r = a r`, `∂²/∂r² = a 1 + b r rᵀ`, `∂²/∂r∂V = c r` with a = 2 s ∂/∂I, b = 4 s² ∂²/∂I², c = 2 s ∂²/∂I∂V.
#[derive(Clone, Copy, Debug)]
pub struct OfSquare<T = f64> {
    value: T,
    at: At<T>,
    rates: At<T>,
}

#[derive(Clone, Copy, Debug)]
struct At<T> {
    r: Vector3<T>,
    a: T,
    b: T,
    c: T,
    row: T,
    entry: T,
}

struct SquareRates<T> {
    at: At<T>,
    rates: At<T>,
}

impl<T: Number> OfSquare<T> {
    /// Makes the blocks from u and e: value and three derivatives by I each.
    #[inline(always)]
    pub(super) fn new<const M: usize>(
        p: &SVector<T, M>,
        w: &SVector<T, M>,
        s: T,
        u: impl Fn(T) -> [T; 4],
        e: impl Fn(T) -> [T; 4],
    ) -> Self {
        let vector = |x: &SVector<T, M>| Vector3::new(x[0], x[1], x[2]);
        let scalar = |x: &SVector<T, M>| if M > 3 { x[3] } else { T::zero() };
        let ((r, v), (r_w, v_w)) = ((vector(p), scalar(p)), (vector(w), scalar(w)));
        let i = s * r.dot(&r);
        let (u, e) = (u(i), e(i));
        // Derivatives by I of the orders 0 to 3, and how they change with V.
        let by_i = |k: usize| u[k] + e[k] * v * v;
        let by_i_v = |k: usize| e[k].scaled(2.0) * v;
        let at = At {
            r,
            a: s.scaled(2.0) * by_i(1),
            b: s.scaled(4.0) * s * by_i(2),
            c: s.scaled(2.0) * by_i_v(1),
            row: by_i_v(0),
            entry: e[0].scaled(2.0),
        };
        let i_w = s.scaled(2.0) * r.dot(&r_w);
        let rate = |k: usize| by_i(k + 1) * i_w + by_i_v(k) * v_w;
        let rate_v = |k: usize| by_i_v(k + 1) * i_w + e[k].scaled(2.0) * v_w;
        let rates = At {
            r: r_w,
            a: s.scaled(2.0) * rate(1),
            b: s.scaled(4.0) * s * rate(2),
            c: s.scaled(2.0) * rate_v(1),
            row: rate_v(0),
            entry: e[1].scaled(2.0) * i_w,
        };
        Self {
            value: by_i(0),
            at,
            rates,
        }
    }
}

impl<T: Number> Local<T> for OfSquare<T> {
    #[inline(always)]
    fn value(&self) -> T {
        self.value
    }

    #[inline(always)]
    fn plain<const NV: usize>(&self) -> impl Derivatives<T> {
        self.at
    }

    #[inline(always)]
    fn along<const NV: usize>(&self) -> impl Derivatives<T> {
        let Self { at, rates, .. } = *self;
        SquareRates { at, rates }
    }
}

impl<T: Number> Derivatives<T> for At<T> {
    #[inline(always)]
    fn force(&self, _: usize) -> Vector3<T> {
        self.r * self.a
    }

    #[inline(always)]
    fn row(&self, _: usize) -> T {
        self.row
    }

    #[inline(always)]
    fn block(&self, _: usize, _: usize) -> Matrix3<T> {
        Matrix3::from_diagonal_element(self.a) + self.r * (self.r * self.b).transpose()
    }

    #[inline(always)]
    fn column(&self, _: usize, _: usize) -> Vector3<T> {
        self.r * self.c
    }

    #[inline(always)]
    fn entry(&self, _: usize, _: usize) -> T {
        self.entry
    }
}

impl<T: Number> Derivatives<T> for SquareRates<T> {
    #[inline(always)]
    fn force(&self, _: usize) -> Vector3<T> {
        self.at.r * self.rates.a + self.rates.r * self.at.a
    }

    #[inline(always)]
    fn row(&self, _: usize) -> T {
        self.rates.row
    }

    /// `ȧ 1 + ḃ r rᵀ + b (r ṙᵀ + ṙ rᵀ)` = `ȧ 1 + r qᵀ + q rᵀ` with q = b ṙ + ½ ḃ r.
    #[inline(always)]
    fn block(&self, _: usize, _: usize) -> Matrix3<T> {
        let (r, q) = (
            self.at.r,
            self.rates.r * self.at.b + self.at.r * self.rates.b.scaled(0.5),
        );
        let one = r * q.transpose();
        Matrix3::from_diagonal_element(self.rates.a) + one + one.transpose()
    }

    #[inline(always)]
    fn column(&self, _: usize, _: usize) -> Vector3<T> {
        self.at.r * self.rates.c + self.rates.r * self.at.c
    }

    #[inline(always)]
    fn entry(&self, _: usize, _: usize) -> T {
        self.rates.entry
    }
}
