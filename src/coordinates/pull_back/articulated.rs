//! Pairs of articulated vectors: dense products of packed columns, four lanes at a time.
//!
//! Vectors with the same support (all vectors of one body, all spans between two) share one small local matrix, which is
//! scattered once; so the cost of scattering does not grow with the number of terms.

use crate::coordinates::pattern::{BlockPattern, StepPattern};
use crate::coordinates::pull_back::destination::{Destination, Site};
use crate::coordinates::pull_back::lanes::{Lanes, image, load, scaled, sum, take};
use crate::coordinates::tree::{LANES, TangentColumns};
use crate::functional::BlockMask;
use crate::math::Matrix;
use std::collections::BTreeMap;
use wide::f64x4;

/// A coupled pair of vectors.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pair {
    pub(super) slot: usize,
    /// Slot of the pair in the other order.
    pub(super) transposed: usize,
    /// Where the columns of both start.
    pub(super) first: [usize; 2],
}

/// Pairs of articulated vectors between two supports.
#[derive(Clone, Debug)]
struct Articulated {
    rows: usize,
    /// Strides of the columns.
    stride: [usize; 2],
    pairs: Vec<Pair>,
    /// Places of the entries, for blocks of one instant and between neighbours.
    same: Vec<Scatter>,
    cross: Vec<Scatter>,
}

/// Where an entry of a local matrix goes.
#[derive(Clone, Copy, Debug)]
struct Scatter {
    from: usize,
    to: usize,
    /// Where it goes in the transposed block.
    transposed: usize,
}

/// Groups of pairs by the supports of both vectors.
#[derive(Clone, Debug, Default)]
pub(super) struct Groups {
    list: BTreeMap<(Vec<usize>, Vec<usize>), Articulated>,
}

/// Packed columns of both ends of a block, and their derivatives along the direction.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ends<'a> {
    pub(super) columns: [&'a [f64]; 2],
    pub(super) columns_l: [&'a [f64]; 2],
}

/// Where blocks go, and the storage on the way.
#[derive(Debug)]
pub(super) struct BlockDestination<'a> {
    pub(super) target: &'a Destination,
    /// Local matrix of one group.
    pub(super) local: &'a mut [f64],
    pub(super) values: &'a mut [f64],
}

impl Groups {
    /// Adds a pair of vectors with these columns.
    pub(super) fn add(
        &mut self,
        pair: Pair,
        [a, b]: [&TangentColumns; 2],
        layout: &mut StepPattern,
        site: Site,
    ) {
        if a.support.is_empty() || b.support.is_empty() {
            return;
        }
        let key = (a.support.clone(), b.support.clone());
        let group = self
            .list
            .entry(key)
            .or_insert_with(|| Articulated::new([a, b], layout, site));
        group.pairs.push(pair);
    }

    /// Size of the largest local matrix.
    pub(super) fn local(&self) -> usize {
        self.list
            .values()
            .map(|g| g.rows * g.stride[1])
            .max()
            .unwrap_or(0)
    }

    /// Adds Pᵀ H P for full blocks.
    pub(super) fn full(
        &self,
        ends: Ends<'_>,
        blocks: &[[Matrix; 4]],
        sides: BlockMask,
        place: BlockDestination<'_>,
    ) {
        let add = |group: &Articulated, side, out: &mut [f64]| {
            group.add_full(ends.of(side), side, blocks, out);
        };
        self.each(sides, place, add, |_| None);
    }

    /// Adds Pᵀ H P for isotropic blocks. They come from potentials: of neighbouring instants the block below the
    /// diagonal is the one above, transposed.
    pub(super) fn isotropic(
        &self,
        ends: Ends<'_>,
        blocks: &[[f64; 4]],
        sides: BlockMask,
        place: BlockDestination<'_>,
    ) {
        let mirrored = sides.blocks[1] && sides.blocks[2];
        let [same, above, below, next] = sides.blocks;
        let upper = BlockMask {
            blocks: [same, above, below && !mirrored, next],
        };
        let add = |group: &Articulated, side, out: &mut [f64]| {
            group.add_isotropic(ends.of(side), side, blocks, out);
        };
        self.each(upper, place, add, |side| {
            (mirrored && side == 1).then_some(2)
        });
    }

    /// Adds `Pᵀ H_w P + P′_lᵀ H P + Pᵀ Hᵀ P′_l` for full blocks, plain and contracted.
    pub(super) fn full_along(
        &self,
        ends: Ends<'_>,
        blocks: [&[[Matrix; 4]]; 2],
        sides: BlockMask,
        place: BlockDestination<'_>,
    ) {
        let add = |group: &Articulated, side, out: &mut [f64]| {
            group.add_full_along(ends.along(side), side, blocks[0], blocks[1], out);
        };
        self.each(sides, place, add, |_| None);
    }

    /// The same for isotropic blocks; within an instant the sum is symmetric.
    pub(super) fn isotropic_along(
        &self,
        ends: Ends<'_>,
        blocks: [&[[f64; 4]]; 2],
        sides: BlockMask,
        place: BlockDestination<'_>,
    ) {
        let add = |group: &Articulated, side, out: &mut [f64]| {
            group.add_isotropic_along(ends.along(side), side, blocks[0], blocks[1], out);
        };
        self.each(sides, place, add, |side| {
            (side == 0 || side == 3).then_some(side)
        });
    }

    /// Scatters what `add` makes of each group and side, and its transpose into the side that `twin` names.
    #[inline]
    fn each(
        &self,
        sides: BlockMask,
        place: BlockDestination<'_>,
        add: impl Fn(&Articulated, usize, &mut [f64]),
        twin: impl Fn(usize) -> Option<usize>,
    ) {
        let BlockDestination {
            target,
            local,
            values,
        } = place;
        for group in self.list.values() {
            for side in (0..4).filter(|&s| sides.blocks[s]) {
                let local = group.local(local);
                add(group, side, local);
                group.scatter(side, target.blocks[side], local, values);
                if let Some(twin) = twin(side) {
                    group.scatter_transposed(side, target.blocks[twin], local, values);
                }
            }
        }
    }
}

impl<'a> Ends<'a> {
    fn of(&self, side: usize) -> [&'a [f64]; 2] {
        [self.columns[side / 2], self.columns[side % 2]]
    }

    fn along(&self, side: usize) -> [&'a [f64]; 4] {
        let [a, b] = self.of(side);
        [a, b, self.columns_l[side / 2], self.columns_l[side % 2]]
    }
}

impl Articulated {
    fn new([a, b]: [&TangentColumns; 2], layout: &mut StepPattern, site: Site) -> Self {
        let places = |pattern: &mut BlockPattern| {
            let mut list = Vec::new();
            for (i, &row) in a.support.iter().enumerate() {
                for (j, &col) in b.support.iter().enumerate() {
                    let (to, transposed) = (pattern.slot(row, col), pattern.slot(col, row));
                    list.push(Scatter {
                        from: i * b.stride + j,
                        to,
                        transposed,
                    });
                }
            }
            list
        };
        Self {
            rows: a.support.len(),
            stride: [a.stride, b.stride],
            pairs: Vec::new(),
            same: places(&mut layout.same),
            cross: match site {
                Site::Intervals => places(&mut layout.cross),
                Site::Instants => Vec::new(),
            },
        }
    }

    /// Adds aᵀ t to the columns from `at`, for the vector whose columns start at `first`.
    #[inline]
    fn add_product(&self, a: &[f64], first: usize, t: &Lanes, at: usize, out: &mut [f64]) {
        let stride = self.stride[0];
        let (x, rest) = a[first..first + 3 * stride].split_at(stride);
        let (y, z) = rest.split_at(stride);
        let rows = out
            .chunks_exact_mut(self.stride[1])
            .zip(x.iter().zip(y.iter().zip(z)));
        for (row, (&x, (&y, &z))) in rows {
            let row = &mut row[at..at + LANES];
            let sum = load(row, 0)
                + t[0] * f64x4::splat(x)
                + t[1] * f64x4::splat(y)
                + t[2] * f64x4::splat(z);
            row.copy_from_slice(&sum.to_array());
        }
    }

    /// Adds aᵀ t + a′ᵀ t′, likewise.
    #[inline]
    fn add_products(
        &self,
        [a, al]: [&[f64]; 2],
        first: usize,
        [t, tl]: [&Lanes; 2],
        at: usize,
        out: &mut [f64],
    ) {
        let stride = self.stride[0];
        let (x, rest) = a[first..first + 3 * stride].split_at(stride);
        let (y, z) = rest.split_at(stride);
        let (xl, rest) = al[first..first + 3 * stride].split_at(stride);
        let (yl, zl) = rest.split_at(stride);
        let rows = out
            .chunks_exact_mut(self.stride[1])
            .zip(x.iter().zip(y.iter().zip(z)));
        for ((row, (&x, (&y, &z))), (&xl, (&yl, &zl))) in rows.zip(xl.iter().zip(yl.iter().zip(zl)))
        {
            let row = &mut row[at..at + LANES];
            let plain = t[0] * f64x4::splat(x) + t[1] * f64x4::splat(y) + t[2] * f64x4::splat(z);
            let along =
                tl[0] * f64x4::splat(xl) + tl[1] * f64x4::splat(yl) + tl[2] * f64x4::splat(zl);
            let sum = load(row, 0) + plain + along;
            row.copy_from_slice(&sum.to_array());
        }
    }

    /// The local matrix, cleared.
    #[inline]
    fn local<'l>(&self, local: &'l mut [f64]) -> &'l mut [f64] {
        let local = &mut local[..self.rows * self.stride[1]];
        local.fill(0.0);
        local
    }

    fn add_full(&self, [a, b]: [&[f64]; 2], side: usize, blocks: &[[Matrix; 4]], out: &mut [f64]) {
        for at in (0..self.stride[1]).step_by(LANES) {
            for pair in &self.pairs {
                let t = image(
                    &blocks[pair.slot][side],
                    &take(b, pair.first[1], self.stride[1], at),
                );
                self.add_product(a, pair.first[0], &t, at, out);
            }
        }
    }

    fn add_isotropic(
        &self,
        [a, b]: [&[f64]; 2],
        side: usize,
        blocks: &[[f64; 4]],
        out: &mut [f64],
    ) {
        for at in (0..self.stride[1]).step_by(LANES) {
            for pair in &self.pairs {
                let t = scaled(
                    blocks[pair.slot][side],
                    &take(b, pair.first[1], self.stride[1], at),
                );
                self.add_product(a, pair.first[0], &t, at, out);
            }
        }
    }

    fn add_full_along(
        &self,
        [a, b, al, bl]: [&[f64]; 4],
        side: usize,
        plain: &[[Matrix; 4]],
        contracted: &[[Matrix; 4]],
        out: &mut [f64],
    ) {
        let other = 2 * (side % 2) + side / 2;
        for at in (0..self.stride[1]).step_by(LANES) {
            for pair in &self.pairs {
                let (h, hw) = (&plain[pair.slot][side], &contracted[pair.slot][side]);
                let ht = plain[pair.transposed][other].transpose();
                let columns = take(b, pair.first[1], self.stride[1], at);
                let columns_l = take(bl, pair.first[1], self.stride[1], at);
                let t = sum(&image(hw, &columns), &image(&ht, &columns_l));
                self.add_products([a, al], pair.first[0], [&t, &image(h, &columns)], at, out);
            }
        }
    }

    /// Within an instant half of the symmetric sum, `Jᵀ(½ h_w J + h J′)`; the transpose is the other half.
    fn add_isotropic_along(
        &self,
        [a, b, al, bl]: [&[f64]; 4],
        side: usize,
        plain: &[[f64; 4]],
        contracted: &[[f64; 4]],
        out: &mut [f64],
    ) {
        let within = side == 0 || side == 3;
        for at in (0..self.stride[1]).step_by(LANES) {
            for pair in &self.pairs {
                let (h, hw) = (plain[pair.slot][side], contracted[pair.slot][side]);
                let columns = take(b, pair.first[1], self.stride[1], at);
                let columns_l = take(bl, pair.first[1], self.stride[1], at);
                if within {
                    let t = sum(&scaled(0.5 * hw, &columns), &scaled(h, &columns_l));
                    self.add_product(a, pair.first[0], &t, at, out);
                } else {
                    let t = sum(&scaled(hw, &columns), &scaled(h, &columns_l));
                    self.add_products([a, al], pair.first[0], [&t, &scaled(h, &columns)], at, out);
                }
            }
        }
    }

    fn places(&self, side: usize) -> &[Scatter] {
        if side == 1 || side == 2 {
            &self.cross
        } else {
            &self.same
        }
    }

    #[inline]
    fn scatter(&self, side: usize, base: usize, local: &[f64], values: &mut [f64]) {
        let values = &mut values[base..];
        for place in self.places(side) {
            values[place.to] += local[place.from];
        }
    }

    #[inline]
    fn scatter_transposed(&self, side: usize, base: usize, local: &[f64], values: &mut [f64]) {
        let values = &mut values[base..];
        for place in self.places(side) {
            values[place.transposed] += local[place.from];
        }
    }
}
