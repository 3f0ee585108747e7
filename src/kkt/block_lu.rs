//! Dense blocks of equations with as many unknowns or more, by `faer`.
//!
//! A block is A = [A_D A_F] with the unknowns exchanged so that `Aᵀ = [L₁; L₂] U`: exchanges of rows of Aᵀ choose the unknowns that the equations
//! determine. Then `A_D = Uᵀ L₁ᵀ` and `A_D⁻¹ A_F = L₁⁻ᵀ L₂ᵀ`, in which no small pivot of U occurs.

use std::fmt;

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::lu::partial_pivoting::factor;
use faer::linalg::triangular_solve as triangular;
use faer::{MatMut, MatRef, Par};
use pulp::Simd;

use super::lanes::{dot, subtract};

/// Least pivot against the entries of its equation; less is an error of rounding.
const REGULAR: f64 = 1e-14;

/// A block with its factors.
#[derive(Clone, Debug)]
pub(super) struct BlockLu {
    unknowns: usize,
    equations: usize,
    /// Aᵀ by columns.
    values: Vec<f64>,
    /// Exchanges of unknowns and their inverses.
    forward: Vec<usize>,
    inverse: Vec<usize>,
}

/// Memory to factor one block after the other.
pub(super) struct Room {
    /// Greatest entry of each equation.
    largest: Vec<f64>,
    memory: MemBuffer,
}

impl fmt::Debug for Room {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Room")
            .field("equations", &self.largest.len())
            .finish_non_exhaustive()
    }
}

impl Room {
    /// For any of these blocks.
    pub(super) fn of(blocks: &[BlockLu]) -> Self {
        let scratch = |block: &BlockLu| {
            let (rows, columns) = (block.unknowns, block.equations);
            factor::lu_in_place_scratch::<usize, f64>(rows, columns, Par::Seq, Default::default())
        };
        let needed = blocks.iter().map(scratch);
        let equations = blocks.iter().map(|block| block.equations);
        Self {
            largest: vec![0.0; equations.max().unwrap_or(0)],
            memory: MemBuffer::new(needed.fold(Default::default(), |all, one| one.or(all))),
        }
    }
}

impl BlockLu {
    /// A block of so many equations and unknowns.
    pub(super) fn new(equations: usize, unknowns: usize) -> Self {
        Self {
            unknowns,
            equations,
            values: vec![0.0; equations * unknowns],
            forward: vec![0; unknowns],
            inverse: vec![0; unknowns],
        }
    }

    /// Makes it zero.
    pub(super) fn clear(&mut self) {
        self.values.fill(0.0);
    }

    /// Adds to an entry.
    pub(super) fn add(&mut self, equation: usize, unknown: usize, value: f64) {
        self.values[unknown + equation * self.unknowns] += value;
    }

    /// Factors it; false where its equations depend on each other, or are no finite numbers.
    pub(super) fn factor(&mut self, room: &mut Room) -> bool {
        let (n, equations, values) = (self.unknowns, self.equations, &mut self.values);
        for (largest, column) in room.largest.iter_mut().zip(values.chunks_exact(n)) {
            *largest = column.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
        }
        factor::lu_in_place(
            MatMut::from_column_major_slice_mut(values, n, equations),
            &mut self.forward,
            &mut self.inverse,
            Par::Seq,
            MemStack::new(&mut room.memory),
            Default::default(),
        );
        let mut pivots = room.largest.iter().zip(values.iter().step_by(n + 1));
        pivots
            .by_ref()
            .take(equations)
            .all(|(largest, pivot)| pivot.abs() > REGULAR * largest)
    }

    /// Its unknowns: those that its equations determine, then the free ones.
    pub(super) fn order(&self) -> &[usize] {
        &self.forward
    }

    /// Replaces columns of right-hand sides, one behind the other, by `A_D⁻¹` times them.
    pub(super) fn solve(&self, right: &mut [f64]) {
        let (square, _) = self.parts();
        let mut right = columns(right, self.equations);
        let par = Par::Seq;
        triangular::solve_lower_triangular_in_place(square.transpose(), right.as_mut(), par);
        triangular::solve_unit_upper_triangular_in_place(square.transpose(), right, par);
    }

    /// The same with `A_D⁻ᵀ`.
    pub(super) fn solve_transposed(&self, right: &mut [f64]) {
        let (square, _) = self.parts();
        let mut right = columns(right, self.equations);
        let par = Par::Seq;
        triangular::solve_unit_lower_triangular_in_place(square, right.as_mut(), par);
        triangular::solve_upper_triangular_in_place(square, right, par);
    }

    /// `A_D⁻¹` of one column.
    #[inline(always)]
    pub(super) fn solve_one<S: Simd>(&self, unit: S, right: &mut [f64]) {
        let columns = self.values.chunks_exact(self.unknowns);
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
    pub(super) fn solve_one_transposed<S: Simd>(&self, unit: S, right: &mut [f64]) {
        let columns = self.values.chunks_exact(self.unknowns);
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

    /// `A_D⁻¹ A_F`, one column for each free unknown.
    pub(super) fn free(&self, to: &mut [f64]) {
        let (square, free) = self.parts();
        let mut to = columns(to, self.equations);
        to.copy_from(free.transpose());
        triangular::solve_unit_upper_triangular_in_place(square.transpose(), to, Par::Seq);
    }

    /// L₁ and U in one square, and L₂.
    fn parts(&self) -> (MatRef<'_, f64>, MatRef<'_, f64>) {
        MatRef::from_column_major_slice(&self.values, self.unknowns, self.equations)
            .split_at_row(self.equations)
    }
}

fn columns(numbers: &mut [f64], rows: usize) -> MatMut<'_, f64> {
    let count = numbers.len() / rows;
    MatMut::from_column_major_slice_mut(numbers, rows, count)
}
