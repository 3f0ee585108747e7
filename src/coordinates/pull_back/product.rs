//! The dense product of a group, with the sums of a few rows and columns in registers.

use crate::coordinates::tree::LANES;
use pulp::Simd;

/// A coupled pair of vectors.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pair {
    pub(super) slot: u32,
    /// Slot of the pair in the other order.
    pub(super) transposed: u32,
    /// Offsets at which the columns of both start.
    pub(super) first: [u32; 2],
}

/// `out ← Σ aᵀ t` over all pairs of all panels, a the columns of the first vector and t the image.
pub(super) struct Product<'a> {
    pub(super) pairs: &'a [Pair],
    /// Columns of all vectors, and images of those of the second vectors of the pairs.
    pub(super) panels: &'a [[&'a [f64]; 2]],
    /// Numbers a row of the columns of first vectors, and of the images.
    pub(super) stride: [usize; 2],
    /// Rows of the result that are asked for.
    pub(super) rows: usize,
    pub(super) out: &'a mut [f64],
}

impl Product<'_> {
    #[inline(always)]
    pub(super) fn run<S: Simd>(self, unit: S) {
        match S::F64_LANES {
            4 => self.by::<S, 1, 2>(unit),
            2 => self.by::<S, 2, 4>(unit),
            1 => self.by::<S, 4, 8>(unit),
            lanes => unreachable!("rows are padded to {LANES} numbers, not to {lanes}"),
        }
    }

    /// Four columns take `ONE` registers, eight `TWO`.
    #[inline(always)]
    fn by<S: Simd, const ONE: usize, const TWO: usize>(mut self, unit: S) {
        let columns = self.stride[1];
        let mut at = 0;
        while at + 2 * LANES <= columns {
            self.columns_from::<S, TWO>(unit, at);
            at += 2 * LANES;
        }
        if at < columns {
            self.columns_from::<S, ONE>(unit, at);
        }
    }

    #[inline(always)]
    fn columns_from<S: Simd, const K: usize>(&mut self, unit: S, at: usize) {
        for row in (0..self.rows).step_by(4) {
            match self.rows - row {
                1 => self.block::<S, 1, K>(unit, row, at),
                2 => self.block::<S, 2, K>(unit, row, at),
                3 => self.block::<S, 3, K>(unit, row, at),
                _ => self.block::<S, 4, K>(unit, row, at),
            }
        }
    }

    /// `R` rows from `row`, `K` registers of columns from `at`.
    #[inline(always)]
    fn block<S: Simd, const R: usize, const K: usize>(&mut self, unit: S, row: usize, at: usize) {
        let [rows, columns] = self.stride;
        let width = K * S::F64_LANES;
        let mut sums = [[unit.splat_f64s(0.0); K]; R];
        for [all, images] in self.panels {
            let images = images.chunks_exact(3 * columns);
            for (pair, image) in self.pairs.iter().zip(images) {
                let first = &all[pair.first[0] as usize..][..3 * rows];
                for k in 0..3 {
                    let a = &first[k * rows + row..][..R];
                    let t = S::as_simd_f64s(&image[k * columns + at..][..width]).0;
                    for (sums, &a) in sums.iter_mut().zip(a) {
                        let a = unit.splat_f64s(a);
                        for (sum, &t) in sums.iter_mut().zip(t) {
                            *sum = unit.mul_add_e_f64s(a, t, *sum);
                        }
                    }
                }
            }
        }
        for (i, sums) in sums.iter().enumerate() {
            let out = &mut self.out[(row + i) * columns + at..][..width];
            S::as_mut_simd_f64s(out).0.copy_from_slice(sums);
        }
    }
}

#[cfg(test)]
#[path = "../../../tests/units/coordinates/product.rs"]
mod tests;
