//! A dense front, and the elimination of one pivot of it.
//!
//! Loops over numbers with the vector unit of the machine.

use pulp::Simd;

/// A dense symmetric matrix, of which the leading columns may be eliminated.
#[derive(Debug)]
pub(super) struct Dense<'a> {
    /// Lower triangle by columns; the rest is of no meaning.
    pub(super) values: &'a mut [f64],
    /// Rows.
    pub(super) order: usize,
    /// Distance from one column to the next, a whole number of groups.
    pub(super) stride: usize,
    /// Columns that may be eliminated.
    pub(super) candidates: usize,
    /// Unknown of each row, sorted along.
    pub(super) unknowns: &'a mut [u32],
    /// D⁻¹ of eliminated columns: diagonal, and the entry below of the first of a pair.
    pub(super) pivots: &'a mut [[f64; 2]],
}

impl Dense<'_> {
    /// Entry of the lower triangle.
    #[inline(always)]
    pub(super) fn at(&self, row: usize, column: usize) -> f64 {
        self.values[row + column * self.stride]
    }

    /// Makes column `q` an eliminated one that holds nothing.
    pub(super) fn clear(&mut self, q: usize) {
        self.pivots[q] = [0.0; 2];
        self.values[q * self.stride + q + 1..][..self.order - q - 1].fill(0.0);
    }

    /// Eliminates column `q`; updates the columns up to `end`, notes L D, and returns the number of negative eigenvalues.
    #[inline(always)]
    pub(super) fn eliminate_one<S: Simd>(
        &mut self,
        unit: S,
        q: usize,
        end: usize,
        unscaled: &mut [f64],
    ) -> usize {
        let stride = self.stride;
        let (left, right) = self.values.split_at_mut((q + 1) * stride);
        let column = &mut left[q * stride..];
        let diagonal = column[q];
        let inverse = diagonal.recip();
        self.pivots[q] = [inverse, 0.0];
        unscaled[end..self.order].copy_from_slice(&column[end..self.order]);
        for j in q + 1..end {
            let factor = column[j] * inverse;
            if factor != 0.0 {
                let from = j / GROUP * GROUP;
                let target = &mut right[(j - q - 1) * stride + from..(j - q) * stride];
                subtract(unit, target, &column[from..], factor);
            }
        }
        for entry in &mut column[q + 1..self.order] {
            *entry *= inverse;
        }
        usize::from(diagonal < 0.0)
    }

    /// The same for the pair of columns `q` and `q + 1`.
    #[inline(always)]
    pub(super) fn eliminate_two<S: Simd>(
        &mut self,
        unit: S,
        q: usize,
        end: usize,
        unscaled: &mut [f64],
    ) -> usize {
        let stride = self.stride;
        let (left, right) = self.values.split_at_mut((q + 2) * stride);
        let (first, second) = left[q * stride..].split_at_mut(stride);
        let (a, o, b) = (first[q], first[q + 1], second[q + 1]);
        let determinant = a * b - o * o;
        let [i, k, l] = [b, -o, a].map(|entry| entry / determinant);
        (self.pivots[q], self.pivots[q + 1]) = ([i, k], [l, 0.0]);
        let (noted_first, noted_second) = unscaled.split_at_mut(stride);
        noted_first[end..self.order].copy_from_slice(&first[end..self.order]);
        noted_second[end..self.order].copy_from_slice(&second[end..self.order]);
        for j in q + 2..end {
            let (x, y) = (first[j], second[j]);
            let (s, t) = (i * x + k * y, k * x + l * y);
            if s != 0.0 || t != 0.0 {
                let from = j / GROUP * GROUP;
                let target = &mut right[(j - q - 2) * stride + from..(j - q - 1) * stride];
                subtract_two(unit, target, &first[from..], s, &second[from..], t);
            }
        }
        let rows = q + 2..self.order;
        for (x, y) in first[rows.clone()].iter_mut().zip(&mut second[rows]) {
            (*x, *y) = (i * *x + k * *y, k * *x + l * *y);
        }
        first[q + 1] = 0.0;
        match determinant < 0.0 {
            true => 1,
            false => 2 * usize::from(a < 0.0),
        }
    }

    /// Exchanges two candidates, with what is eliminated already.
    pub(super) fn swap(&mut self, a: usize, b: usize) {
        if a == b {
            return;
        }
        let (a, b, stride) = (a.min(b), a.max(b), self.stride);
        self.unknowns.swap(a, b);
        for j in 0..a {
            self.values.swap(a + j * stride, b + j * stride);
        }
        self.values.swap(a + a * stride, b + b * stride);
        for i in a + 1..b {
            self.values.swap(i + a * stride, b + i * stride);
        }
        let (left, right) = self.values.split_at_mut(b * stride);
        left[a * stride..][b + 1..self.order].swap_with_slice(&mut right[b + 1..self.order]);
    }
}

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
