//! Values of the components at all nodes of a grid, between margins that neighbours beyond the grid may be read from.

use crate::sparse::multigrid::node_grid::COMPONENTS;

/// A block of the matrix, by column.
pub(super) type Block = [f32; COMPONENTS * COMPONENTS];

/// Values at the nodes: as a rule those of the components in single precision.
#[derive(Clone, Debug)]
pub(super) struct Field<T = [f32; COMPONENTS]> {
    pub(super) values: Vec<T>,
    pub(super) margin: usize,
}

impl<T: Copy + Default> Field<T> {
    /// Zero at all nodes of a grid.
    pub(super) fn new([n_x, n_y, n_z]: [usize; 3]) -> Self {
        let margin = n_x * n_y + n_x + 1;
        Self {
            values: vec![T::default(); n_x * n_y * n_z + 2 * margin],
            margin,
        }
    }

    /// The nodes without the margins.
    pub(super) fn nodes(&self) -> &[T] {
        &self.values[self.margin..self.values.len() - self.margin]
    }

    /// The nodes without the margins.
    pub(super) fn nodes_mut(&mut self) -> &mut [T] {
        let end = self.values.len() - self.margin;
        &mut self.values[self.margin..end]
    }
}

/// Adds a block times a vector.
#[inline(always)]
pub(super) fn add(sum: &mut [f32; COMPONENTS], block: &Block, x: &[f32; COMPONENTS]) {
    for (column, x) in block.chunks_exact(COMPONENTS).zip(x) {
        for (sum, entry) in sum.iter_mut().zip(column) {
            *sum += entry * x;
        }
    }
}
