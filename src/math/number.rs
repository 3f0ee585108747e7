//! Numbers of a formula: plain ones, and those with their derivatives by two parameters.

use nalgebra::{ClosedAddAssign, ClosedMulAssign, ClosedSubAssign, Scalar};
use num_traits::{One, Zero};
use std::ops::{Add, AddAssign, Mul, MulAssign, Neg, Sub, SubAssign};

/// A number of a formula: a plain one, or one that carries derivatives.
pub trait Number:
    Scalar
    + Copy
    + Zero
    + One
    + Neg<Output = Self>
    + ClosedAddAssign
    + ClosedSubAssign
    + ClosedMulAssign
    + Send
    + Sync
{
    /// A constant.
    fn of(value: f64) -> Self;

    /// Its value.
    fn real(self) -> f64;

    /// c self.
    #[must_use]
    fn scaled(self, c: f64) -> Self;

    /// f(self), from f, f′ and f″ at its value.
    #[must_use]
    fn map(self, f: [f64; 3]) -> Self;

    /// self + c.
    #[inline(always)]
    #[must_use]
    fn shifted(self, c: f64) -> Self {
        self + Self::of(c)
    }

    /// 1/self.
    #[inline(always)]
    #[must_use]
    fn recip(self) -> Self {
        let r = 1.0 / self.real();
        self.map([r, -r * r, 2.0 * r * r * r])
    }

    /// self/b.
    #[inline(always)]
    #[must_use]
    fn over(self, b: Self) -> Self {
        self * b.recip()
    }

    /// √self; NaN below zero.
    #[inline(always)]
    #[must_use]
    fn sqrt(self) -> Self {
        let (s, r) = (self.real().sqrt(), 1.0 / self.real());
        self.map([s, 0.5 * s * r, -0.25 * s * r * r])
    }

    /// ln self; NaN below zero.
    #[inline(always)]
    #[must_use]
    fn ln(self) -> Self {
        let r = 1.0 / self.real();
        self.map([self.real().ln(), r, -r * r])
    }

    /// e to the power self.
    #[inline(always)]
    #[must_use]
    fn exp(self) -> Self {
        self.map([self.real().exp(); 3])
    }

    /// self to the power n, for a positive self.
    #[inline(always)]
    #[must_use]
    fn powf(self, n: Self) -> Self {
        (self.ln() * n).exp()
    }

    /// selfⁿ for a whole n ≥ 1.
    #[inline(always)]
    #[must_use]
    fn powi(self, n: i32) -> Self {
        let (x, m) = (self.real(), f64::from(n));
        self.map([x.powi(n), m * x.powi(n - 1), m * (m - 1.0) * x.powi(n - 2)])
    }
}

impl Number for f64 {
    #[inline(always)]
    fn of(value: f64) -> Self {
        value
    }

    #[inline(always)]
    fn real(self) -> f64 {
        self
    }

    #[inline(always)]
    fn scaled(self, c: f64) -> Self {
        self * c
    }

    #[inline(always)]
    fn map(self, f: [f64; 3]) -> Self {
        f[0]
    }

    #[inline(always)]
    fn recip(self) -> Self {
        1.0 / self
    }

    #[inline(always)]
    fn over(self, b: Self) -> Self {
        self / b
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        Self::sqrt(self)
    }

    #[inline(always)]
    fn ln(self) -> Self {
        Self::ln(self)
    }

    #[inline(always)]
    fn exp(self) -> Self {
        Self::exp(self)
    }

    #[inline(always)]
    fn powf(self, n: Self) -> Self {
        Self::powf(self, n)
    }

    #[inline(always)]
    fn powi(self, n: i32) -> Self {
        Self::powi(self, n)
    }
}

/// A hyper-dual number `value + a ε₁ + b ε₂ + ab ε₁ε₂` with ε₁² = ε₂² = 0: a number with its derivatives by two parameters and the mixed
/// second one (Fike and Alonso, 2011).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HyperDual {
    /// The value.
    pub value: f64,
    /// Derivative by the first parameter.
    pub a: f64,
    /// Derivative by the second parameter.
    pub b: f64,
    /// The mixed second derivative.
    pub ab: f64,
}

impl HyperDual {
    #[inline(always)]
    fn with(self, other: Self, f: impl Fn(f64, f64) -> f64) -> Self {
        Self {
            value: f(self.value, other.value),
            a: f(self.a, other.a),
            b: f(self.b, other.b),
            ab: f(self.ab, other.ab),
        }
    }
}

impl Number for HyperDual {
    #[inline(always)]
    fn of(value: f64) -> Self {
        Self {
            value,
            a: 0.0,
            b: 0.0,
            ab: 0.0,
        }
    }

    #[inline(always)]
    fn real(self) -> f64 {
        self.value
    }

    #[inline(always)]
    fn scaled(self, c: f64) -> Self {
        self.with(self, |x, _| x * c)
    }

    #[inline(always)]
    fn map(self, f: [f64; 3]) -> Self {
        Self {
            value: f[0],
            a: f[1] * self.a,
            b: f[1] * self.b,
            ab: f[1] * self.ab + f[2] * self.a * self.b,
        }
    }
}

impl Add for HyperDual {
    type Output = Self;

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        self.with(other, |x, y| x + y)
    }
}

impl Sub for HyperDual {
    type Output = Self;

    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        self.with(other, |x, y| x - y)
    }
}

impl Mul for HyperDual {
    type Output = Self;

    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        let (x, y) = (self, other);
        Self {
            value: x.value * y.value,
            a: x.a * y.value + x.value * y.a,
            b: x.b * y.value + x.value * y.b,
            ab: x.ab * y.value + x.a * y.b + x.b * y.a + x.value * y.ab,
        }
    }
}

impl Neg for HyperDual {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        self.scaled(-1.0)
    }
}

impl AddAssign for HyperDual {
    #[inline(always)]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl SubAssign for HyperDual {
    #[inline(always)]
    fn sub_assign(&mut self, other: Self) {
        *self = *self - other;
    }
}

impl MulAssign for HyperDual {
    #[inline(always)]
    fn mul_assign(&mut self, other: Self) {
        *self = *self * other;
    }
}

impl Zero for HyperDual {
    #[inline(always)]
    fn zero() -> Self {
        Self::of(0.0)
    }

    #[inline(always)]
    fn is_zero(&self) -> bool {
        *self == Self::of(0.0)
    }
}

impl One for HyperDual {
    #[inline(always)]
    fn one() -> Self {
        Self::of(1.0)
    }
}
