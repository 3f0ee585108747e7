//! Dense blocks of equations with as many unknowns or more, by `faer`.
//!
//! A block is A = [A_D A_F] with the unknowns exchanged so that `Aᵀ = [L₁; L₂] U`: exchanges of rows of Aᵀ choose the unknowns that the equations
//! determine. Then `A_D = Uᵀ L₁ᵀ` and `A_D⁻¹ A_F = L₁⁻ᵀ L₂ᵀ`, in which no small pivot of U occurs.

use std::fmt;
use std::ops::Range;
use std::slice::ChunksExact;

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::lu::partial_pivoting::factor;
use faer::linalg::triangular_solve as triangular;
use faer::{MatMut, MatRef, Par};
use pulp::Simd;

use super::lanes::{dot, subtract};

/// Least pivot against the entries of its equation; less is an error of rounding.
const REGULAR: f64 = 1e-14;

/// Blocks with their factors.
pub(super) struct BlockLu {
    blocks: Vec<Block>,
    values: Vec<f64>,
    /// Exchanges of unknowns and their inverses.
    forward: Vec<usize>,
    inverse: Vec<usize>,
    /// Greatest entry of each equation.
    largest: Vec<f64>,
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
    /// Its unknowns among all.
    unknowns: Range<usize>,
    equations: usize,
    /// Aᵀ by columns.
    values: Range<usize>,
}

impl BlockLu {
    /// Blocks of so many equations and unknowns.
    pub(super) fn new(shapes: impl Iterator<Item = (usize, usize)>) -> Self {
        let (mut unknowns, mut values, mut needed) = (0, 0, Default::default());
        let mut most = 0;
        let block = |(rows, columns): (usize, usize)| {
            let par = Par::Seq;
            let scratch =
                factor::lu_in_place_scratch::<usize, f64>(columns, rows, par, Default::default());
            needed = scratch.or(needed);
            most = most.max(rows);
            let block = Block {
                unknowns: unknowns..unknowns + columns,
                equations: rows,
                values: values..values + rows * columns,
            };
            (unknowns, values) = (block.unknowns.end, block.values.end);
            block
        };
        Self {
            blocks: shapes.map(block).collect(),
            values: vec![0.0; values],
            forward: vec![0; unknowns],
            inverse: vec![0; unknowns],
            largest: vec![0.0; most],
            memory: MemBuffer::new(needed),
        }
    }

    /// Makes all blocks zero.
    pub(super) fn clear(&mut self) {
        self.values.fill(0.0);
    }

    /// Adds to an entry of block `k`; equation and unknown are counted within the block.
    pub(super) fn add(&mut self, k: usize, equation: usize, unknown: usize, value: f64) {
        let block = &self.blocks[k];
        let at = unknown + equation * block.unknowns.len();
        self.values[block.values.start + at] += value;
    }

    /// Factors block `k`; false where its equations depend on each other, or are no finite numbers.
    pub(super) fn factor(&mut self, k: usize) -> bool {
        let Block {
            unknowns,
            equations,
            values,
        } = self.blocks[k].clone();
        let n = unknowns.len();
        let values = &mut self.values[values];
        for (largest, column) in self.largest.iter_mut().zip(values.chunks_exact(n)) {
            *largest = column.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
        }
        factor::lu_in_place(
            MatMut::from_column_major_slice_mut(values, n, equations),
            &mut self.forward[unknowns.clone()],
            &mut self.inverse[unknowns],
            Par::Seq,
            MemStack::new(&mut self.memory),
            Default::default(),
        );
        let mut pivots = self.largest.iter().zip(values.iter().step_by(n + 1));
        pivots
            .by_ref()
            .take(equations)
            .all(|(largest, pivot)| pivot.abs() > REGULAR * largest)
    }

    /// The unknowns of block `k`, counted within it: those that its equations determine, then the free ones.
    pub(super) fn order(&self, k: usize) -> &[usize] {
        &self.forward[self.blocks[k].unknowns.clone()]
    }

    /// Replaces columns of right-hand sides, one behind the other, by `A_D⁻¹` times them.
    pub(super) fn solve(&self, k: usize, right: &mut [f64]) {
        let (square, _) = self.parts(k);
        let mut right = columns(right, self.blocks[k].equations);
        let par = Par::Seq;
        triangular::solve_lower_triangular_in_place(square.transpose(), right.as_mut(), par);
        triangular::solve_unit_upper_triangular_in_place(square.transpose(), right, par);
    }

    /// The same with `A_D⁻ᵀ`.
    pub(super) fn solve_transposed(&self, k: usize, right: &mut [f64]) {
        let (square, _) = self.parts(k);
        let mut right = columns(right, self.blocks[k].equations);
        let par = Par::Seq;
        triangular::solve_unit_lower_triangular_in_place(square, right.as_mut(), par);
        triangular::solve_upper_triangular_in_place(square, right, par);
    }

    /// `A_D⁻¹` of one column.
    #[inline(always)]
    pub(super) fn solve_one<S: Simd>(&self, unit: S, k: usize, right: &mut [f64]) {
        let columns = self.columns(k);
        for (j, column) in columns.clone().enumerate() {
            let known = dot(unit, &column[..j], &right[..j]);
            right[j] = (right[j] - known) / column[j];
        }
        let e = right.len();
        for (j, column) in columns.enumerate().rev() {
            let (value, known) = right[j..].split_first_mut().expect("a row for each column");
            *value -= dot(unit, &column[j + 1..e], known);
        }
    }

    /// `A_D⁻ᵀ` of one column.
    #[inline(always)]
    pub(super) fn solve_one_transposed<S: Simd>(&self, unit: S, k: usize, right: &mut [f64]) {
        let columns = self.columns(k);
        let e = right.len();
        for (j, column) in columns.clone().enumerate() {
            let (value, below) = right[j..].split_first_mut().expect("a row for each column");
            subtract(unit, below, &column[j + 1..e], *value);
        }
        for (j, column) in columns.enumerate().rev() {
            let value = right[j] / column[j];
            right[j] = value;
            subtract(unit, &mut right[..j], &column[..j], value);
        }
    }

    /// L and U of block `k`, column by column.
    fn columns(&self, k: usize) -> ChunksExact<'_, f64> {
        let block = &self.blocks[k];
        self.values[block.values.clone()].chunks_exact(block.unknowns.len())
    }

    /// `A_D⁻¹ A_F`, one column for each free unknown.
    pub(super) fn free(&self, k: usize, to: &mut [f64]) {
        let (square, free) = self.parts(k);
        let mut to = columns(to, self.blocks[k].equations);
        to.copy_from(free.transpose());
        triangular::solve_unit_upper_triangular_in_place(square.transpose(), to, Par::Seq);
    }

    /// L₁ and U of block `k` in one square, and L₂.
    fn parts(&self, k: usize) -> (MatRef<'_, f64>, MatRef<'_, f64>) {
        let block = &self.blocks[k];
        let (n, equations) = (block.unknowns.len(), block.equations);
        let values = &self.values[block.values.clone()];
        MatRef::from_column_major_slice(values, n, equations).split_at_row(equations)
    }
}

fn columns(numbers: &mut [f64], rows: usize) -> MatMut<'_, f64> {
    let count = numbers.len() / rows;
    MatMut::from_column_major_slice_mut(numbers, rows, count)
}
