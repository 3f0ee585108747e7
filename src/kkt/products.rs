//! Products of sparse parts of a matrix with responses of states, which are dense.

use pulp::{Simd, WithSimd};

use super::block::{Block, Item};
use super::lanes::subtract;

/// `to ← to − B S` for a sparse B: rows of `to` have `width` numbers and begin with row `first`; S stands where each item says.
pub(super) struct Product<'a> {
    pub(super) items: &'a [Item],
    pub(super) values: &'a [f64],
    pub(super) from: &'a [f64],
    pub(super) starts: &'a [usize],
    pub(super) to: &'a mut [f64],
    pub(super) first: usize,
    pub(super) width: usize,
}

impl WithSimd for Product<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, unit: S) {
        for item in self.items {
            let value = self.values[item.value as usize];
            let column = item.column as usize;
            let from = &self.from[self.starts[column]..self.starts[column + 1]];
            let to = (item.row as usize - self.first) * self.width + item.place as usize;
            subtract(unit, &mut self.to[to..to + from.len()], from, value);
        }
    }
}

/// `to ← to + H S` of one block, half of it for its own states.
pub(super) struct Curvature<'a> {
    pub(super) block: &'a Block,
    pub(super) values: &'a [f64],
    pub(super) from: &'a [f64],
    pub(super) starts: &'a [usize],
    pub(super) to: &'a mut [f64],
}

impl WithSimd for Curvature<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, unit: S) {
        let Self {
            block,
            values,
            from,
            starts,
            to,
        } = self;
        let (first, width) = (block.states.start, block.weighted.len());
        for item in &block.curvature {
            let (row, column) = (item.row as usize, item.column as usize);
            let value = values[item.value as usize];
            let is_own = column >= first;
            let value = if is_own { 0.5 * value } else { value };
            let response = &from[starts[column]..starts[column + 1]];
            let at = (row - first) * width + item.place as usize;
            subtract(unit, &mut to[at..at + response.len()], response, -value);
            if is_own && row != column {
                let response = &from[starts[row]..starts[row + 1]];
                let at = (column - first) * width + item.place as usize;
                subtract(unit, &mut to[at..at + response.len()], response, -value);
            }
        }
    }
}
