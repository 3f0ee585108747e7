//! Dense square blocks with their factors P A = L U, by `faer`.

use std::fmt;
use std::ops::Range;

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::lu::partial_pivoting::{factor, solve};
use faer::perm::PermRef;
use faer::{Conj, MatMut, MatRef, Par};

/// Blocks on the diagonal of a matrix; rows of all blocks are counted through.
pub(super) struct BlockLu {
    blocks: Vec<Block>,
    values: Vec<f64>,
    /// Row permutations and their inverses.
    forward: Vec<usize>,
    inverse: Vec<usize>,
    memory: MemBuffer,
}

impl fmt::Debug for BlockLu {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("BlockLu")
            .field("blocks", &self.blocks)
            .finish_non_exhaustive()
    }
}

#[derive(Clone, Debug)]
struct Block {
    rows: Range<usize>,
    values: Range<usize>,
}

impl BlockLu {
    /// Blocks of these rows, for right-hand sides of at most `columns` columns.
    pub(super) fn new(rows: &[Range<usize>], columns: usize) -> Self {
        let mut end = 0;
        let block = |rows: &Range<usize>| {
            let begin = end;
            end += rows.len() * rows.len();
            Block {
                rows: rows.clone(),
                values: begin..end,
            }
        };
        let blocks: Vec<Block> = rows.iter().map(block).collect();
        let count = rows.last().map_or(0, |rows| rows.end);
        let largest = rows.iter().map(Range::len).max().unwrap_or(0);
        let (par, columns) = (Par::Seq, columns.max(1));
        let needed =
            factor::lu_in_place_scratch::<usize, f64>(largest, largest, par, Default::default())
                .or(solve::solve_in_place_scratch::<usize, f64>(
                    largest, columns, par,
                ))
                .or(solve::solve_transpose_in_place_scratch::<usize, f64>(
                    largest, columns, par,
                ));
        Self {
            blocks,
            values: vec![0.0; end],
            forward: vec![0; count],
            inverse: vec![0; count],
            memory: MemBuffer::new(needed),
        }
    }

    /// Makes all blocks zero.
    pub(super) fn clear(&mut self) {
        self.values.fill(0.0);
    }

    /// Adds to an entry of block `k`, in rows and columns counted through.
    pub(super) fn add(&mut self, k: usize, row: usize, column: usize, value: f64) {
        let Block { rows, values } = &self.blocks[k];
        let at = row - rows.start + (column - rows.start) * rows.len();
        self.values[values.start + at] += value;
    }

    /// Factors block `k`. A singular one has factors that are no finite numbers.
    pub(super) fn factor(&mut self, k: usize) {
        let Block { rows, values } = self.blocks[k].clone();
        let n = rows.len();
        let matrix = MatMut::from_column_major_slice_mut(&mut self.values[values], n, n);
        let (forward, inverse) = (&mut self.forward[rows.clone()], &mut self.inverse[rows]);
        let stack = MemStack::new(&mut self.memory);
        factor::lu_in_place(
            matrix,
            forward,
            inverse,
            Par::Seq,
            stack,
            Default::default(),
        );
    }

    /// Replaces columns of right-hand sides, one behind the other, by the solutions with block `k`, or with its transpose.
    pub(super) fn solve(&mut self, k: usize, right: &mut [f64], is_transposed: bool) {
        let Block { rows, values } = self.blocks[k].clone();
        let n = rows.len();
        let matrix = MatRef::from_column_major_slice(&self.values[values], n, n);
        let (forward, inverse) = (&self.forward[rows.clone()], &self.inverse[rows]);
        let order = PermRef::new_checked(forward, inverse, n);
        let columns = right.len() / n;
        let right = MatMut::from_column_major_slice_mut(right, n, columns);
        let stack = MemStack::new(&mut self.memory);
        match is_transposed {
            false => solve::solve_in_place_with_conj(
                matrix,
                matrix,
                order,
                Conj::No,
                right,
                Par::Seq,
                stack,
            ),
            true => solve::solve_transpose_in_place_with_conj(
                matrix,
                matrix,
                order,
                Conj::No,
                right,
                Par::Seq,
                stack,
            ),
        }
    }
}
