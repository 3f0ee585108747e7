//! Numbers of a formula at Gauss points: eight lanes of a vector unit, or those with a derivative.
//!
//! A formula of an element is written once over [`Points`]. Over [`Lanes`](super::lanes::Lanes) it is evaluated at all Gauss points side by
//! side; over dual numbers of lanes, [`Dual`](super::dual::Dual), its result carries the derivative along a direction of its arguments.
//! [`dispatch`](super::lanes::dispatch()) chooses the widest vector unit of the machine at run time.
//!
//! Vectors and linear maps of space over the numbers of a formula.
//!
//! Written out, without `array::map`: a closure that is not inlined leaves the vector unit, and costs more than its work.

use std::ops::{Add, Mul, Neg, Sub};

/// A number of a field, with the functions that material laws need.
pub trait Real:
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
pub trait Points: Real {
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
    /// A number with its rate along a direction, which numbers without derivative drop.
    fn uniform(value: f64, rate: f64) -> Self::Uniform;
    /// The same at each point.
    fn moving(token: Self::Token, values: &[f64; 8], rates: &[f64; 8]) -> Self;
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

/// A vector of space.
pub(super) type Three<N> = [N; 3];
/// A linear map of space, by rows.
pub(super) type Nine<N> = [[N; 3]; 3];

/// a·b.
#[inline(always)]
pub(super) fn dot<N: Real>(a: Three<N>, b: Three<N>) -> N {
    (a[0] * b[0])
        .plus_product(a[1], b[1])
        .plus_product(a[2], b[2])
}

/// a × b.
#[inline(always)]
pub(super) fn cross<N: Real>(a: Three<N>, b: Three<N>) -> Three<N> {
    [
        (a[1] * b[2]).minus_product(a[2], b[1]),
        (a[2] * b[0]).minus_product(a[0], b[2]),
        (a[0] * b[1]).minus_product(a[1], b[0]),
    ]
}

/// c a.
#[inline(always)]
pub(super) fn scale<N: Real>(a: Three<N>, c: N) -> Three<N> {
    [a[0] * c, a[1] * c, a[2] * c]
}

/// c M.
#[inline(always)]
pub(super) fn scale_all<N: Real>(m: &Nine<N>, c: N) -> Nine<N> {
    [scale(m[0], c), scale(m[1], c), scale(m[2], c)]
}

/// M a.
#[inline(always)]
pub(super) fn apply<N: Real>(m: &Nine<N>, a: Three<N>) -> Three<N> {
    [dot(m[0], a), dot(m[1], a), dot(m[2], a)]
}

/// Mᵀ.
#[inline(always)]
pub(super) fn transpose<N: Real>(m: &Nine<N>) -> Nine<N> {
    [
        [m[0][0], m[1][0], m[2][0]],
        [m[0][1], m[1][1], m[2][1]],
        [m[0][2], m[1][2], m[2][2]],
    ]
}

/// M a of a vector of the reference configuration.
#[inline(always)]
pub(super) fn apply_plain<N: Points>(m: &Nine<N>, a: Three<N::Plain>) -> Three<N> {
    [dot_plain(m[0], a), dot_plain(m[1], a), dot_plain(m[2], a)]
}

/// a·b with a vector of the reference configuration.
#[inline(always)]
pub(super) fn dot_plain<N: Points>(a: Three<N>, b: Three<N::Plain>) -> N {
    a[0].times(b[0])
        .plus_times(a[1], b[1])
        .plus_times(a[2], b[2])
}

/// cof F, whose rows are cross products of the rows of F.
#[inline(always)]
pub(super) fn cofactor<N: Real>(f: &Nine<N>) -> Nine<N> {
    [cross(f[1], f[2]), cross(f[2], f[0]), cross(f[0], f[1])]
}

/// The sums of a vector over the Gauss points.
#[inline(always)]
pub(super) fn sums<N: Points>(a: Three<N>) -> Three<N::Uniform> {
    [a[0].sum(), a[1].sum(), a[2].sum()]
}

/// A B.
#[inline(always)]
pub(super) fn product<N: Real>(a: &Nine<N>, b: &Nine<N>) -> Nine<N> {
    let b = transpose(b);
    [apply(&b, a[0]), apply(&b, a[1]), apply(&b, a[2])]
}

/// A:B.
#[inline(always)]
pub(super) fn contracted<N: Real>(a: &Nine<N>, b: &Nine<N>) -> N {
    dot(a[0], b[0]) + dot(a[1], b[1]) + dot(a[2], b[2])
}

/// ½ (A + Aᵀ).
#[inline(always)]
pub(super) fn symmetric<N: Real>(a: &Nine<N>) -> Nine<N> {
    let xy = (a[0][1] + a[1][0]).scaled(0.5);
    let yz = (a[1][2] + a[2][1]).scaled(0.5);
    let zx = (a[2][0] + a[0][2]).scaled(0.5);
    [[a[0][0], xy, zx], [xy, a[1][1], yz], [zx, yz, a[2][2]]]
}
