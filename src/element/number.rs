//! Numbers of a formula at Gauss points: eight lanes of a vector unit, or those with a derivative.
//!
//! A formula of an element is written once over [`Points`]. Over [`Lanes`](super::lanes::Lanes) it is evaluated at all Gauss points side by
//! side; over dual numbers of lanes, [`Dual`](super::dual::Dual), its result carries the derivative along a direction of its arguments.
//! [`dispatch`](super::dispatch::dispatch()) chooses the widest vector unit of the machine at run time.

use std::ops::{Add, Mul, Neg, Sub};

/// A number of a field, with the functions that material laws need.
pub(super) trait Real:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Neg<Output = Self>
{
    /// self + a b.
    fn plus_product(self, a: Self, b: Self) -> Self;
    /// self − a b.
    fn minus_product(self, a: Self, b: Self) -> Self;
    /// c self.
    fn scaled(self, c: f64) -> Self;
    /// self + c.
    fn shifted(self, c: f64) -> Self;
    /// 1/self.
    fn recip(self) -> Self;
    /// ln self; NaN for self ≤ 0.
    fn ln(self) -> Self;
    /// e to the power self.
    fn exp(self) -> Self;
}

/// A number at each of the eight Gauss points.
pub(super) trait Points: Real {
    /// The vector unit.
    type Token: Copy;
    /// Numbers of the reference configuration, without derivative.
    type Plain: Points<Token = Self::Token, Plain = Self::Plain>;
    /// The same number at all Gauss points, or a sum over them.
    type Uniform: Real;

    /// The same number at all points.
    fn splat(token: Self::Token, value: Self::Uniform) -> Self;
    /// A constant.
    fn constant(token: Self::Token, value: f64) -> Self;
    /// Numbers of the reference configuration.
    fn load(token: Self::Token, values: &[f64; 8]) -> Self::Plain;
    /// self + b.
    fn plus_plain(self, b: Self::Plain) -> Self;
    /// self b.
    fn times(self, b: Self::Plain) -> Self;
    /// self + a b.
    fn plus_times(self, a: Self, b: Self::Plain) -> Self;
    /// The number itself where it is positive, otherwise NaN.
    fn positive(self) -> Self;
    /// The sum over the points.
    fn sum(self) -> Self::Uniform;
    /// The number at each point.
    fn each(self) -> [Self::Uniform; 8];
}

impl Real for f64 {
    #[inline(always)]
    fn plus_product(self, a: Self, b: Self) -> Self {
        self + a * b
    }

    #[inline(always)]
    fn minus_product(self, a: Self, b: Self) -> Self {
        self - a * b
    }

    #[inline(always)]
    fn scaled(self, c: f64) -> Self {
        c * self
    }

    #[inline(always)]
    fn shifted(self, c: f64) -> Self {
        self + c
    }

    #[inline(always)]
    fn recip(self) -> Self {
        1.0 / self
    }

    #[inline(always)]
    fn exp(self) -> Self {
        Self::exp(self)
    }

    #[inline(always)]
    fn ln(self) -> Self {
        if self > 0.0 {
            Self::ln(self)
        } else {
            Self::NAN
        }
    }
}
