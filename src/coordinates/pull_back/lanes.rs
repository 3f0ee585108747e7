//! Four neighbouring columns of a vector at a time.

use crate::coordinates::tree::LANES;
use crate::math::Matrix;
use wide::f64x4;

/// Four neighbouring columns of a vector: its three rows.
pub(super) type Lanes = [f64x4; 3];

/// The columns from `at` of a vector.
#[inline]
pub(super) fn take(columns: &[f64], first: usize, stride: usize, at: usize) -> Lanes {
    let row = |i: usize| load(columns, first + i * stride + at);
    [row(0), row(1), row(2)]
}

#[inline]
pub(super) fn load(values: &[f64], at: usize) -> f64x4 {
    let lanes: [f64; LANES] = values[at..at + LANES]
        .try_into()
        .expect("rows are padded to whole lanes");
    f64x4::from(lanes)
}

/// m b.
#[inline]
pub(super) fn image(m: &Matrix, b: &Lanes) -> Lanes {
    let row = |i: usize| {
        b[0] * f64x4::splat(m[(i, 0)])
            + b[1] * f64x4::splat(m[(i, 1)])
            + b[2] * f64x4::splat(m[(i, 2)])
    };
    [row(0), row(1), row(2)]
}

/// c b.
#[inline]
pub(super) fn scaled(c: f64, b: &Lanes) -> Lanes {
    let c = f64x4::splat(c);
    [b[0] * c, b[1] * c, b[2] * c]
}

#[inline]
pub(super) fn sum(a: &Lanes, b: &Lanes) -> Lanes {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}
