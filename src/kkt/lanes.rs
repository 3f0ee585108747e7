//! Loops over numbers with the vector unit of the machine.

use pulp::Simd;

/// Columns of fronts are padded to whole groups of this number of rows.
pub(super) const GROUP: usize = 8;

/// The least multiple of [`GROUP`] that is no less than `length`.
pub(super) const fn padded(length: usize) -> usize {
    length.next_multiple_of(GROUP)
}

/// `y ← y − s x`.
#[inline(always)]
pub(super) fn subtract<S: Simd>(unit: S, y: &mut [f64], x: &[f64], s: f64) {
    let factor = unit.splat_f64s(-s);
    let (ys, y) = S::as_mut_simd_f64s(y);
    let (xs, x) = S::as_simd_f64s(x);
    for (y, x) in ys.iter_mut().zip(xs) {
        *y = unit.mul_add_f64s(factor, *x, *y);
    }
    for (y, x) in y.iter_mut().zip(x) {
        *y -= s * x;
    }
}

/// `y ← y − s x − t z`.
#[inline(always)]
pub(super) fn subtract_two<S: Simd>(unit: S, y: &mut [f64], x: &[f64], s: f64, z: &[f64], t: f64) {
    let factors = [unit.splat_f64s(-s), unit.splat_f64s(-t)];
    let (ys, y) = S::as_mut_simd_f64s(y);
    let ((xs, x), (zs, z)) = (S::as_simd_f64s(x), S::as_simd_f64s(z));
    for ((y, x), z) in ys.iter_mut().zip(xs).zip(zs) {
        *y = unit.mul_add_f64s(factors[1], *z, unit.mul_add_f64s(factors[0], *x, *y));
    }
    for ((y, x), z) in y.iter_mut().zip(x).zip(z) {
        *y -= s * x + t * z;
    }
}

/// `x · y`.
#[inline(always)]
pub(super) fn dot<S: Simd>(unit: S, x: &[f64], y: &[f64]) -> f64 {
    let ((xs, x), (ys, y)) = (S::as_simd_f64s(x), S::as_simd_f64s(y));
    let (x_pairs, x_last) = xs.as_chunks::<2>();
    let (y_pairs, y_last) = ys.as_chunks::<2>();
    let mut sums = [unit.splat_f64s(0.0); 2];
    for (x, y) in x_pairs.iter().zip(y_pairs) {
        sums[0] = unit.mul_add_f64s(x[0], y[0], sums[0]);
        sums[1] = unit.mul_add_f64s(x[1], y[1], sums[1]);
    }
    for (x, y) in x_last.iter().zip(y_last) {
        sums[0] = unit.mul_add_f64s(*x, *y, sums[0]);
    }
    let rest: f64 = x.iter().zip(y).map(|(x, y)| x * y).sum();
    unit.reduce_sum_f64s(unit.add_f64s(sums[0], sums[1])) + rest
}

/// Greatest magnitude; 0 of no numbers.
#[inline(always)]
pub(super) fn largest<S: Simd>(unit: S, x: &[f64]) -> f64 {
    let (xs, x) = S::as_simd_f64s(x);
    let mut most = unit.splat_f64s(0.0);
    for x in xs {
        most = unit.max_f64s(unit.abs_f64s(*x), most);
    }
    let rest = x.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
    unit.reduce_max_f64s(most).max(rest)
}
