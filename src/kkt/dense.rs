//! A dense front, and the elimination of one pivot of it.

use pulp::Simd;

use super::lanes::{GROUP, subtract, subtract_two};

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
