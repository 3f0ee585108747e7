//! Pairs of vectors with the same support: all vectors of one body, all spans between two.
//!
//! They share one small local matrix, a dense product of their columns and of the images of these under the blocks. It is
//! scattered once, so the cost of scattering does not grow with the number of terms. Along a chain each support begins with the
//! one before: those that take as many columns when padded are one group, and one product.

use crate::coordinates::pattern::BlockPattern;
use crate::coordinates::pull_back::destination::{Plan, Site};
use crate::coordinates::pull_back::images::{Columns, Pairs};
use crate::coordinates::pull_back::product::Product;
use crate::math::compact_index;
use pulp::Simd;

/// Pairs of vectors with two supports, or with beginnings of these that are padded to as many columns.
#[derive(Clone, Debug)]
pub(super) struct Group {
    /// The longest supports.
    supports: [Vec<usize>; 2],
    /// Lengths of all supports taken in.
    taken: Vec<[usize; 2]>,
    /// Strides of the columns.
    stride: [usize; 2],
    pub(super) pairs: Pairs,
    /// Places of the entries, for blocks of one instant and between neighbours.
    same: Vec<Scatter>,
    cross: Vec<Scatter>,
}

/// Destination of an entry of a local matrix.
#[derive(Clone, Copy, Debug)]
struct Scatter {
    from: u32,
    to: u32,
    /// Its position in the transposed block.
    transposed: u32,
}

impl Group {
    pub(super) fn new(stride: [usize; 2]) -> Self {
        Self {
            supports: [Vec::new(), Vec::new()],
            taken: Vec::new(),
            stride,
            pairs: Pairs::default(),
            same: Vec::new(),
            cross: Vec::new(),
        }
    }

    /// Returns true if pairs of these supports belong to it: one support is the beginning of the other on both sides.
    pub(super) fn fits(&self, supports: &[Vec<usize>; 2], stride: [usize; 2]) -> bool {
        let mut both = self.supports.iter().zip(supports);
        self.stride == stride && both.all(|(s, t)| s.starts_with(t) || t.starts_with(s))
    }

    /// Takes in pairs of these supports: their entries join the layout.
    pub(super) fn widen(&mut self, supports: &[Vec<usize>; 2], plan: &mut Plan<'_>) {
        let (stride, taken) = (self.stride[1], &self.taken);
        let is_taken = |i, j| taken.iter().any(|&[m, n]| i < m && j < n);
        let place = |list: &mut Vec<Scatter>, pattern: &mut BlockPattern| {
            for (i, &row) in supports[0].iter().enumerate() {
                for (j, &col) in supports[1].iter().enumerate() {
                    if !is_taken(i, j) {
                        list.push(Scatter {
                            from: compact_index(i * stride + j),
                            to: compact_index(pattern.slot(row, col)),
                            transposed: compact_index(pattern.slot(col, row)),
                        });
                    }
                }
            }
        };
        place(&mut self.same, &mut plan.layout.same);
        if plan.site == Site::Intervals {
            place(&mut self.cross, &mut plan.layout.cross);
        }
        self.taken.push([0, 1].map(|k| supports[k].len()));
        for (own, other) in self.supports.iter_mut().zip(supports) {
            if other.len() > own.len() {
                own.clone_from(other);
            }
        }
    }

    /// Numbers of the storage that it needs.
    pub(super) fn local(&self) -> usize {
        let [a, b] = self.stride;
        6 * self.pairs.list().len() * b + a * b
    }

    /// The storage of the images of `panels` times all pairs, and of the local matrix.
    #[inline(always)]
    pub(super) fn split<'l>(
        &self,
        local: &'l mut [f64],
        panels: usize,
    ) -> (&'l mut [f64], &'l mut [f64]) {
        let [a, b] = self.stride;
        let pairs = self.pairs.list().len();
        let (images, rest) = local.split_at_mut(3 * panels * pairs * b);
        (images, &mut rest[..a * b])
    }

    /// The columns at the instants of a side, of the first vectors and of the second ones.
    #[inline(always)]
    pub(super) fn columns<'c>(&self, ends: [&'c [f64]; 2], side: usize) -> [Columns<'c>; 2] {
        let [a, b] = self.stride;
        [
            Columns::new(ends[side / 2], a),
            Columns::new(ends[side % 2], b),
        ]
    }

    /// The local matrix.
    #[inline(always)]
    pub(super) fn multiply<S: Simd>(&self, unit: S, panels: &[[&[f64]; 2]], out: &mut [f64]) {
        Product {
            pairs: self.pairs.list(),
            panels,
            stride: self.stride,
            rows: self.supports[0].len(),
            out,
        }
        .run(unit);
    }

    #[inline(always)]
    fn places(&self, side: usize) -> &[Scatter] {
        if side == 1 || side == 2 {
            &self.cross
        } else {
            &self.same
        }
    }

    #[inline(always)]
    pub(super) fn scatter(&self, side: usize, base: usize, local: &[f64], values: &mut [f64]) {
        let values = &mut values[base..];
        for place in self.places(side) {
            values[place.to as usize] += local[place.from as usize];
        }
    }

    #[inline(always)]
    pub(super) fn scatter_transposed(
        &self,
        side: usize,
        base: usize,
        local: &[f64],
        values: &mut [f64],
    ) {
        let values = &mut values[base..];
        for place in self.places(side) {
            values[place.transposed as usize] += local[place.from as usize];
        }
    }
}
