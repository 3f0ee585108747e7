//! Numbers of a formula: plain ones, and those with their derivatives by one parameter or two.

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

/// A dual number `value + part ε` with ε² = 0: a number with its derivative by a parameter. That of a dual number has the derivatives by two
/// parameters and the mixed second one (hyper-dual numbers; Fike and Alonso, 2011); a third level has none, for want of third derivatives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dual<T> {
    /// The value.
    pub value: T,
    /// Its derivative.
    pub part: T,
}

/// A number with its derivatives by two parameters: `value.part` by the first, `part.value` by the second, and the mixed one, `part.part`.
pub type HyperDual = Dual<Dual<f64>>;

impl<T: Number> Number for Dual<T> {
    #[inline(always)]
    fn of(value: f64) -> Self {
        Self {
            value: T::of(value),
            part: T::zero(),
        }
    }

    #[inline(always)]
    fn real(self) -> f64 {
        self.value.real()
    }

    #[inline(always)]
    fn scaled(self, c: f64) -> Self {
        Self {
            value: self.value.scaled(c),
            part: self.part.scaled(c),
        }
    }

    #[inline(always)]
    fn map(self, f: [f64; 3]) -> Self {
        Self {
            value: self.value.map(f),
            part: self.part * self.value.map([f[1], f[2], f64::NAN]),
        }
    }
}

impl<T: Number> Add for Dual<T> {
    type Output = Self;

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self {
            value: self.value + other.value,
            part: self.part + other.part,
        }
    }
}

impl<T: Number> Sub for Dual<T> {
    type Output = Self;

    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self {
            value: self.value - other.value,
            part: self.part - other.part,
        }
    }
}

impl<T: Number> Mul for Dual<T> {
    type Output = Self;

    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        Self {
            value: self.value * other.value,
            part: self.part * other.value + self.value * other.part,
        }
    }
}

impl<T: Number> Neg for Dual<T> {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        self.scaled(-1.0)
    }
}

impl<T: Number> AddAssign for Dual<T> {
    #[inline(always)]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl<T: Number> SubAssign for Dual<T> {
    #[inline(always)]
    fn sub_assign(&mut self, other: Self) {
        *self = *self - other;
    }
}

impl<T: Number> MulAssign for Dual<T> {
    #[inline(always)]
    fn mul_assign(&mut self, other: Self) {
        *self = *self * other;
    }
}

impl<T: Number> Zero for Dual<T> {
    #[inline(always)]
    fn zero() -> Self {
        Self::of(0.0)
    }

    #[inline(always)]
    fn is_zero(&self) -> bool {
        *self == Self::of(0.0)
    }
}

impl<T: Number> One for Dual<T> {
    #[inline(always)]
    fn one() -> Self {
        Self::of(1.0)
    }
}
