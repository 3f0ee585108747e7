//! Columns of vectors, and their images under the blocks of pairs: three rows for each pair, as long as the columns.

use crate::coordinates::pull_back::product::Pair;
use crate::functional::Blocks;
use crate::math::Matrix;
use pulp::Simd;
use std::slice::ChunksExactMut;

/// Columns of all vectors, of which those of one group have rows of `stride` numbers.
#[derive(Clone, Copy, Debug)]
pub(super) struct Columns<'a> {
    pub(super) all: &'a [f64],
    stride: usize,
}

/// Pairs of one group: those with full blocks, then those with isotropic ones.
#[derive(Clone, Debug, Default)]
pub(super) struct Pairs {
    list: Vec<Pair>,
    full: usize,
}

impl<'a> Columns<'a> {
    #[inline(always)]
    pub(super) fn new(all: &'a [f64], stride: usize) -> Self {
        Self { all, stride }
    }

    /// The three rows of the vector whose columns start at `first`.
    #[inline(always)]
    fn of(&self, first: u32) -> &'a [f64] {
        &self.all[first as usize..][..3 * self.stride]
    }

    /// Makes images of this number of vectors, one by one.
    #[inline(always)]
    fn images<'i>(&self, images: &'i mut [f64]) -> ChunksExactMut<'i, f64> {
        images.chunks_exact_mut(3 * self.stride)
    }
}

impl Pairs {
    /// All pairs, in the order of their images.
    #[inline(always)]
    pub(super) fn list(&self) -> &[Pair] {
        &self.list
    }

    /// Adds a pair.
    pub(super) fn add(&mut self, kind: BlockKind, pair: Pair) {
        match kind {
            BlockKind::Full => {
                self.list.insert(self.full, pair);
                self.full += 1;
            }
            BlockKind::Isotropic => self.list.push(pair),
        }
    }

    /// Images H b of the columns of the second vectors.
    #[inline(always)]
    pub(super) fn images<S: Simd>(
        &self,
        unit: S,
        side: usize,
        blocks: &Blocks,
        b: Columns<'_>,
        images: &mut [f64],
    ) {
        let (to_full, to_isotropic) = images.split_at_mut(self.full * 3 * b.stride);
        let (of_full, of_isotropic) = self.list.split_at(self.full);
        for (pair, image) in of_full.iter().zip(b.images(to_full)) {
            let h = blocks.full[pair.slot as usize][side];
            full(unit, [(h, b.of(pair.first[1]))], image);
        }
        for (pair, image) in of_isotropic.iter().zip(b.images(to_isotropic)) {
            let h = blocks.isotropic[pair.slot as usize][side];
            isotropic(unit, h, b.of(pair.first[1]), image);
        }
    }

    /// Images `c H_w b + Hᵀ b′` of plain blocks H and contracted blocks `H_w`.
    #[inline(always)]
    pub(super) fn images_along<S: Simd>(
        &self,
        unit: S,
        side: usize,
        [h, hw]: [&Blocks; 2],
        c: f64,
        [b, bl]: [Columns<'_>; 2],
        images: &mut [f64],
    ) {
        let other = 2 * (side % 2) + side / 2;
        let (to_full, to_isotropic) = images.split_at_mut(self.full * 3 * b.stride);
        let (of_full, of_isotropic) = self.list.split_at(self.full);
        for (pair, image) in of_full.iter().zip(b.images(to_full)) {
            let ht = h.full[pair.transposed as usize][other].transpose();
            let hw = hw.full[pair.slot as usize][side] * c;
            let at = pair.first[1];
            full(unit, [(hw, b.of(at)), (ht, bl.of(at))], image);
        }
        for (pair, image) in of_isotropic.iter().zip(b.images(to_isotropic)) {
            let h = h.isotropic[pair.slot as usize][side];
            let hw = hw.isotropic[pair.slot as usize][side] * c;
            let at = pair.first[1];
            two_isotropic(unit, hw, b.of(at), h, bl.of(at), image);
        }
    }
}

/// Σ m b.
#[inline(always)]
fn full<S: Simd, const N: usize>(unit: S, terms: [(Matrix, &[f64]); N], image: &mut [f64]) {
    let stride = image.len() / 3;
    for (i, row) in image.chunks_exact_mut(stride).enumerate() {
        let mut is_first = true;
        for (m, b) in &terms {
            let (x, rest) = b.split_at(stride);
            let (y, z) = rest.split_at(stride);
            let (x, y, z) = (simd::<S>(x), simd::<S>(y), simd::<S>(z));
            let p = unit.splat_f64s(m[(i, 0)]);
            let q = unit.splat_f64s(m[(i, 1)]);
            let r = unit.splat_f64s(m[(i, 2)]);
            let sums = S::as_mut_simd_f64s(row).0.iter_mut();
            for (sum, (&x, (&y, &z))) in sums.zip(x.iter().zip(y.iter().zip(z))) {
                let first = if is_first {
                    unit.mul_f64s(p, x)
                } else {
                    unit.mul_add_e_f64s(p, x, *sum)
                };
                *sum = unit.mul_add_e_f64s(r, z, unit.mul_add_e_f64s(q, y, first));
            }
            is_first = false;
        }
    }
}

/// c b.
#[inline(always)]
fn isotropic<S: Simd>(unit: S, c: f64, b: &[f64], image: &mut [f64]) {
    let c = unit.splat_f64s(c);
    let sums = S::as_mut_simd_f64s(image).0.iter_mut();
    for (sum, &b) in sums.zip(simd::<S>(b)) {
        *sum = unit.mul_f64s(c, b);
    }
}

/// c b + d e.
#[inline(always)]
fn two_isotropic<S: Simd>(unit: S, c: f64, b: &[f64], d: f64, e: &[f64], image: &mut [f64]) {
    let (c, d) = (unit.splat_f64s(c), unit.splat_f64s(d));
    let sums = S::as_mut_simd_f64s(image).0.iter_mut();
    for (sum, (&b, &e)) in sums.zip(simd::<S>(b).iter().zip(simd::<S>(e))) {
        *sum = unit.mul_add_e_f64s(c, b, unit.mul_f64s(d, e));
    }
}

/// Numbers of padded rows.
#[inline(always)]
fn simd<S: Simd>(row: &[f64]) -> &[S::f64s] {
    S::as_simd_f64s(row).0
}

/// Kind of the block of a pair.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum BlockKind {
    Full,
    /// A multiple of the identity; it comes from an energy, and is the same for the pair in the other order.
    Isotropic,
}
