//! Values of the components at all nodes of a grid, between margins that neighbours beyond the grid may be read from.

use crate::sparse::multigrid::node_grid::COMPONENTS;
use nalgebra::Matrix4;

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

    /// Zero at so many nodes of a mesh, whose neighbours all have a place.
    pub(super) fn of_mesh(count: usize) -> Self {
        Self {
            values: vec![T::default(); count],
            margin: 0,
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

/// The inverse of a block on the diagonal, in which rows and columns of given values are zero; `None` where it is singular.
pub(super) fn inverse_of(block: &Block) -> Option<Block> {
    let mut own = Matrix4::from_fn(|row, col| f64::from(block[COMPONENTS * col + row]));
    // Of given values the whole row is zero.
    let given = [0, 1, 2, 3].map(|component| own[(component, component)] == 0.0);
    for component in (0..COMPONENTS).filter(|&c| given[c]) {
        own[(component, component)] = 1.0;
    }
    let mut found = own.try_inverse()?;
    for component in (0..COMPONENTS).filter(|&c| given[c]) {
        found[(component, component)] = 0.0;
    }
    let mut inverse = Block::default();
    for (entry, value) in inverse.iter_mut().zip(found.iter()) {
        *entry = *value as f32;
    }
    let is_finite = inverse.iter().all(|entry| entry.is_finite());
    is_finite.then_some(inverse)
}

/// Adds the transpose of a block times a vector.
#[inline(always)]
pub(super) fn add_transposed(sum: &mut [f32; COMPONENTS], block: &Block, x: &[f32; COMPONENTS]) {
    for (column, sum) in block.chunks_exact(COMPONENTS).zip(sum) {
        for (x, entry) in x.iter().zip(column) {
            *sum += entry * x;
        }
    }
}

/// Adds the product of two blocks.
#[inline(always)]
pub(super) fn add_product(sum: &mut Block, a: &Block, b: &Block) {
    for column in 0..COMPONENTS {
        for middle in 0..COMPONENTS {
            let factor = b[COMPONENTS * column + middle];
            for row in 0..COMPONENTS {
                sum[COMPONENTS * column + row] += a[COMPONENTS * middle + row] * factor;
            }
        }
    }
}

/// Adds the product of the transpose of a block and another one.
#[inline(always)]
pub(super) fn add_transposed_product(sum: &mut Block, a: &Block, b: &Block) {
    let mut turned = Block::default();
    for column in 0..COMPONENTS {
        for row in 0..COMPONENTS {
            turned[COMPONENTS * column + row] = a[COMPONENTS * row + column];
        }
    }
    add_product(sum, &turned, b);
}
