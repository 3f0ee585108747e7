//! The matrix of one level of a mesh in single precision, with the pattern of its rows.

use crate::sparse::multigrid::block_rows::BlockRows;
use crate::sparse::multigrid::node_grid::Block;
use crate::sparse::multigrid::triangles::{Rows, Triangles};
use std::ops::Range;
use std::sync::Arc;

/// A block with its column.
type Coupling<'m> = (&'m Block, &'m u32);

/// A matrix with blocks by row.
#[derive(Debug)]
pub(super) struct MeshMatrix {
    pub(super) rows: Arc<BlockRows>,
    /// First block of each row in the lower triangle, and the number of all.
    lower_starts: Vec<usize>,
    blocks: Triangles,
}

impl MeshMatrix {
    /// Zero, with this pattern.
    pub(super) fn new(rows: Arc<BlockRows>) -> Self {
        let (nodes, lower_starts) = (rows.count(), rows.lower_starts());
        let lower = lower_starts[nodes];
        let counts = [lower, rows.blocks() - nodes - lower];
        Self {
            blocks: Triangles::new(nodes, counts),
            lower_starts,
            rows,
        }
    }

    /// Writes the blocks, which count row by row.
    pub(super) fn write(&mut self, of: impl Fn(usize) -> Block) {
        let mut number = 0;
        self.each_mut(|_, _, block| {
            *block = of(number);
            number += 1;
        });
    }

    /// Calls `change` with row, column and block of each.
    pub(super) fn each_mut(&mut self, mut change: impl FnMut(usize, usize, &mut Block)) {
        let mut rows = self.blocks.rows_mut();
        for (row, column) in self.rows.entries() {
            change(row, column, rows.next(row, column));
        }
    }

    /// Both halves of the rows.
    pub(super) fn in_two(&mut self) -> [Rows<'_>; 2] {
        let half = self.rows.count() / 2;
        let before = self.halves(half).map(|blocks| blocks.start);
        self.blocks.rows_mut().split_at(half, before)
    }

    /// Places of a row in the lower and in the upper triangle.
    #[inline(always)]
    fn halves(&self, row: usize) -> [Range<usize>; 2] {
        let (start, end) = (self.rows.range(row).start, self.rows.range(row).end);
        let [lower, behind] = [self.lower_starts[row], self.lower_starts[row + 1]];
        [lower..behind, start - row - lower..end - row - 1 - behind]
    }

    /// The blocks of a row, by column.
    #[inline(always)]
    pub(super) fn row(&self, row: usize) -> impl Iterator<Item = &Block> {
        self.blocks.row(row, self.halves(row))
    }

    /// All blocks row by row.
    pub(super) fn blocks(&self) -> impl Iterator<Item = &Block> {
        (0..self.rows.count()).flat_map(|row| self.row(row))
    }

    /// Blocks of a row before the diagonal.
    #[inline(always)]
    pub(super) fn lower(&self, row: usize) -> impl DoubleEndedIterator<Item = Coupling<'_>> {
        let [lower, _] = self.halves(row);
        let columns = &self.rows.columns(row)[..lower.len()];
        self.blocks.lower(lower).iter().zip(columns)
    }

    /// The block on the diagonal.
    #[inline(always)]
    pub(super) fn diagonal(&self, row: usize) -> &Block {
        self.blocks.diagonal(row)
    }

    /// Blocks of a row behind the diagonal.
    #[inline(always)]
    pub(super) fn upper(&self, row: usize) -> impl DoubleEndedIterator<Item = Coupling<'_>> {
        let [lower, upper] = self.halves(row);
        let columns = &self.rows.columns(row)[lower.len() + 1..];
        self.blocks.upper(upper).iter().zip(columns)
    }
}
