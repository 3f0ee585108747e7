//! The update of the columns behind a panel: `C ← C − L Wᵀ` in the lower triangle.
//!
//! Tiles of eight rows and four columns stay in registers while the pivots of the panel run by (Goto and van de Geijn, 2008). Both
//! factors are packed, so that tiles read them in one line.

use crate::kkt::bandwidth_order::{Block, Item};
use crate::kkt::dense::{GROUP, padded, subtract};
use pulp::{Simd, WithSimd};
use std::ops::Range;

/// Columns of a tile.
const COLUMNS: usize = 4;

/// Packed factors, kept from panel to panel.
#[derive(Clone, Debug, Default)]
pub(super) struct Packed {
    left: Vec<f64>,
    right: Vec<f64>,
}

/// The columns of a panel: `pivots` of them, `stride` numbers each.
#[derive(Clone, Copy)]
pub(super) struct Panel<'a> {
    /// L.
    pub(super) left: &'a [f64],
    /// W = L D.
    pub(super) right: &'a [f64],
    /// Length of a column of either.
    pub(super) stride: usize,
    /// Columns of either.
    pub(super) pivots: usize,
}

/// Subtracts `L Wᵀ` from the columns `updated` of a front, whose slice begins with column `from`.
///
/// Above the diagonal and in the padding of columns anything may be written.
#[inline(always)]
pub(super) fn update<S: Simd>(
    unit: S,
    packed: &mut Packed,
    panel: Panel<'_>,
    columns: &mut [f64],
    updated: Range<usize>,
) {
    packed.pack(panel, &updated);
    match S::F64_LANES {
        8 => tiles::<S, 1>(unit, packed, panel, columns, updated),
        4 => tiles::<S, 2>(unit, packed, panel, columns, updated),
        2 => tiles::<S, 4>(unit, packed, panel, columns, updated),
        1 => tiles::<S, 8>(unit, packed, panel, columns, updated),
        lanes => unreachable!("vector units have 1, 2, 4 or 8 lanes of 64 bits, not {lanes}"),
    }
}

/// All tiles that reach the lower triangle, with eight numbers in `K` registers.
#[inline(always)]
fn tiles<S: Simd, const K: usize>(
    unit: S,
    packed: &Packed,
    panel: Panel<'_>,
    columns: &mut [f64],
    updated: Range<usize>,
) {
    let (from, order) = (updated.start, updated.end);
    let group = panel.pivots * GROUP;
    let first = from / GROUP;
    let tiles = packed.right.chunks_exact(panel.pivots * COLUMNS);
    for (right, begin) in tiles.zip((from..order).step_by(COLUMNS)) {
        let count = COLUMNS.min(order - begin);
        let below = &packed.left[(begin / GROUP - first) * group..];
        let rows = (begin / GROUP * GROUP..).step_by(GROUP);
        for (left, row) in below.chunks_exact(group).zip(rows) {
            let place = Place {
                begin: begin - from,
                count,
                row,
                stride: panel.stride,
            };
            tile::<S, K>(unit, left, right, columns, place);
        }
    }
}

/// Position of a tile.
#[derive(Clone, Copy)]
struct Place {
    /// First column of the slice.
    begin: usize,
    /// Columns.
    count: usize,
    /// First row.
    row: usize,
    /// Distance from one column to the next.
    stride: usize,
}

impl Packed {
    #[inline(always)]
    fn pack(&mut self, panel: Panel<'_>, updated: &Range<usize>) {
        let (from, order) = (updated.start, updated.end);
        let Panel {
            left,
            right,
            stride,
            pivots,
        } = panel;
        let first = from / GROUP * GROUP;
        let (rows, columns) = (
            padded(order) - first,
            (order - from).next_multiple_of(COLUMNS),
        );
        let fit = |list: &mut Vec<f64>, length: usize| {
            if list.len() < length {
                list.resize(length, 0.0);
            }
            list.truncate(length);
        };
        fit(&mut self.left, rows * pivots);
        fit(&mut self.right, columns * pivots);
        for t in 0..pivots {
            let column = &left[t * stride + first..t * stride + first + rows];
            let (groups, _) = column.as_chunks::<GROUP>();
            for (group, numbers) in groups.iter().enumerate() {
                let at = (group * pivots + t) * GROUP;
                self.left[at..at + GROUP].copy_from_slice(numbers);
            }
            let column = &right[t * stride + from..t * stride + order];
            for (tile, numbers) in column.chunks(COLUMNS).enumerate() {
                let at = (tile * pivots + t) * COLUMNS;
                let to = &mut self.right[at..at + COLUMNS];
                to[..numbers.len()].copy_from_slice(numbers);
                to[numbers.len()..].fill(0.0);
            }
        }
    }
}

/// One tile.
#[inline(always)]
fn tile<S: Simd, const K: usize>(
    unit: S,
    left: &[f64],
    right: &[f64],
    columns: &mut [f64],
    place: Place,
) {
    let mut sums = [[unit.splat_f64s(0.0); K]; COLUMNS];
    let (left, right) = (left.as_chunks::<GROUP>().0, right.as_chunks::<COLUMNS>().0);
    for (left, right) in left.iter().zip(right) {
        let left: [S::f64s; K] = registers::<S, K>(left);
        for c in 0..COLUMNS {
            let factor = unit.splat_f64s(right[c]);
            for k in 0..K {
                sums[c][k] = unit.mul_add_f64s(left[k], factor, sums[c][k]);
            }
        }
    }
    for (c, sums) in sums.iter().enumerate().take(place.count) {
        let at = (place.begin + c) * place.stride + place.row;
        let (numbers, _) = S::as_mut_simd_f64s(&mut columns[at..at + GROUP]);
        for (number, sum) in numbers.iter_mut().zip(sums) {
            *number = unit.sub_f64s(*number, *sum);
        }
    }
}

#[inline(always)]
fn registers<S: Simd, const K: usize>(numbers: &[f64; GROUP]) -> [S::f64s; K] {
    let (registers, _) = S::as_simd_f64s(numbers);
    std::array::from_fn(|k| registers[k])
}

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
