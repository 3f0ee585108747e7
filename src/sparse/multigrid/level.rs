//! One grid of the hierarchy: its matrix in single precision and the sweeps of block Gauss–Seidel.
//!
//! The matrix has 27 blocks for each node, by column within a block; those of neighbours beyond the grid are zero. Rows and columns of
//! components with given values are zero too.

use crate::sparse::multigrid::axis::Axis;
use crate::sparse::multigrid::field::Field;
use crate::sparse::multigrid::node_grid::{COMPONENTS, NEIGHBOURS, OWN, offsets};
use nalgebra::Matrix4;

/// A block of the matrix, by column.
pub(super) type Block = [f32; COMPONENTS * COMPONENTS];

/// A grid of the hierarchy.
#[derive(Debug)]
pub(super) struct Level {
    pub(super) counts: [usize; 3],
    offsets: [isize; NEIGHBOURS],
    /// For each node, a bit for each component without a given value.
    pub(super) free: Vec<u8>,
    pub(super) matrix: Vec<Block>,
    /// Inverse of the diagonal blocks; rows and columns of given values are zero.
    inverse: Vec<Block>,
    /// Transfer to the next coarser grid; none of the coarsest.
    pub(super) transfer: Option<[Axis; 3]>,
    pub(super) rhs: Field,
    pub(super) x: Field,
    pub(super) residual: Field,
}

/// Adds a block times a vector.
#[inline(always)]
fn add(sum: &mut [f32; COMPONENTS], block: &Block, x: &[f32; COMPONENTS]) {
    for (column, x) in block.chunks_exact(COMPONENTS).zip(x) {
        for (sum, entry) in sum.iter_mut().zip(column) {
            *sum += entry * x;
        }
    }
}

impl Level {
    /// A grid of these nodes without a matrix.
    pub(super) fn new(counts: [usize; 3], free: Vec<u8>, transfer: Option<[Axis; 3]>) -> Self {
        let nodes = free.len();
        Self {
            offsets: offsets(counts),
            matrix: vec![[0.0; COMPONENTS * COMPONENTS]; NEIGHBOURS * nodes],
            inverse: vec![[0.0; COMPONENTS * COMPONENTS]; nodes],
            rhs: Field::new(counts),
            x: Field::new(counts),
            residual: Field::new(counts),
            counts,
            free,
            transfer,
        }
    }

    /// Inverts the diagonal blocks; returns the node whose block is singular, if there is one.
    pub(super) fn invert(&mut self) -> Result<(), usize> {
        for field in [&mut self.rhs, &mut self.x, &mut self.residual] {
            field.values.fill([0.0; COMPONENTS]);
        }
        for (node, inverse) in self.inverse.iter_mut().enumerate() {
            let block = &self.matrix[NEIGHBOURS * node + OWN];
            let mut own = Matrix4::from_fn(|row, col| f64::from(block[COMPONENTS * col + row]));
            // Of given values the whole row is zero.
            let given = [0, 1, 2, 3].map(|component| own[(component, component)] == 0.0);
            for component in (0..COMPONENTS).filter(|&c| given[c]) {
                own[(component, component)] = 1.0;
            }
            let mut found = own.try_inverse().ok_or(node)?;
            for component in (0..COMPONENTS).filter(|&c| given[c]) {
                found[(component, component)] = 0.0;
            }
            for (entry, value) in inverse.iter_mut().zip(found.iter()) {
                *entry = *value as f32;
            }
            if !inverse.iter().all(|entry| entry.is_finite()) {
                return Err(node);
            }
        }
        Ok(())
    }

    /// Places of the neighbours of a node in a field.
    #[inline(always)]
    fn place(&self, node: usize, neighbour: usize) -> usize {
        (node as isize + self.x.margin as isize + self.offsets[neighbour]) as usize
    }

    /// Sum over neighbours of a node of their blocks times their unknowns.
    #[inline(always)]
    fn sum(&self, node: usize, neighbours: impl Iterator<Item = usize>) -> [f32; COMPONENTS] {
        let blocks = &self.matrix[NEIGHBOURS * node..][..NEIGHBOURS];
        let mut sum = [0.0; COMPONENTS];
        for neighbour in neighbours {
            let x = &self.x.values[self.place(node, neighbour)];
            add(&mut sum, &blocks[neighbour], x);
        }
        sum
    }

    /// Solves the equations of a node, of which its neighbours have this sum.
    #[inline(always)]
    fn relax(&mut self, node: usize, sum: [f32; COMPONENTS]) {
        let margin = self.x.margin;
        let rhs = self.rhs.values[node + margin];
        let left: [f32; COMPONENTS] = std::array::from_fn(|c| rhs[c] - sum[c]);
        let mut solution = [0.0; COMPONENTS];
        add(&mut solution, &self.inverse[node], &left);
        self.x.values[node + margin] = solution;
    }

    /// A forward sweep from zero, then what it leaves of the right-hand side: the neighbours behind have had no part in it.
    pub(super) fn sweep_down(&mut self) {
        for node in 0..self.free.len() {
            self.relax(node, self.sum(node, 0..OWN));
        }
        let margin = self.x.margin;
        for node in 0..self.free.len() {
            let sum = self.sum(node, OWN + 1..NEIGHBOURS);
            self.residual.values[node + margin] = sum.map(|s| -s);
        }
    }

    /// A backward sweep.
    pub(super) fn sweep_up(&mut self) {
        for node in (0..self.free.len()).rev() {
            let others = (0..NEIGHBOURS).filter(|&neighbour| neighbour != OWN);
            self.relax(node, self.sum(node, others));
        }
    }
}
