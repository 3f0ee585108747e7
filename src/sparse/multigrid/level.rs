//! Levels from the finest to the coarsest, and one V-cycle through them: matrices in single precision and sweeps of block Gauss–Seidel.
//!
//! Entries of blocks are by column. Rows and columns of components with given values are zero.

use crate::sparse::multigrid::node_grid::{AtNode, Block, COMPONENTS, NodeBlock, inverse_of};
use crate::sparse::multigrid::pressures::{Elements, Interpolation, Pressures};
use crate::sparse::multigrid::slab::{Equations, Slab};
use crate::sparse::multigrid::triangles::{BlockMatrix, BlockRows};
use crate::sparse::{Direct, Singular};
use std::fmt::Debug;
use std::sync::Arc;

/// A level of so few nodes is solved directly.
pub(super) const COARSEST: usize = 100;

/// Transfer to the next coarser level.
pub(super) trait Transfer: Debug + Sized + Interpolation {
    type Elements: Elements;
    /// Places of the nodes of the finest level.
    type Nodes: Debug;

    /// Factor of the diagonal of the coarse matrix.
    const OF_DIAGONAL: f32;

    /// Makes the matrix of the next coarser level, given values included.
    fn coarsen(fine: &mut Level<Self>, coarse: &mut BlockMatrix);

    /// Makes a residual the right-hand side of the next coarser level.
    fn restrict(&self, residual: &[AtNode], rhs: &mut [AtNode]);

    /// Adds the solution of the next coarser level.
    fn correct(&self, x: &mut [AtNode], correction: &[AtNode]);

    /// Number of blocks that are kept.
    fn blocks(&self) -> usize;
}

/// A level.
#[derive(Debug)]
pub(super) struct Level<T: Transfer> {
    pub(super) matrix: BlockMatrix,
    slabs: Vec<Slab>,
    /// For each node, a bit for each component without a given value.
    pub(super) free: Vec<u8>,
    /// Inverse of the diagonal blocks; rows and columns of given values are zero.
    pub(super) inverse: Vec<Block>,
    pub(super) rhs: Vec<AtNode>,
    pub(super) x: Vec<AtNode>,
    pub(super) residual: Vec<AtNode>,
    /// Pressures of elements, where they resist changes of volume.
    pub(super) pressures: Option<Pressures<T::Elements>>,
    /// Transfer to the next coarser level; none of the coarsest.
    pub(super) transfer: Option<T>,
}

impl<T: Transfer> Level<T> {
    /// A level without a matrix.
    pub(super) fn new(
        rows: Arc<BlockRows>,
        slabs: Vec<Slab>,
        free: Vec<u8>,
        transfer: Option<T>,
        elements: Option<T::Elements>,
    ) -> Self {
        let zero = || vec![AtNode::default(); free.len()];
        Self {
            matrix: BlockMatrix::new(rows),
            slabs,
            inverse: vec![Block::default(); free.len()],
            rhs: zero(),
            x: zero(),
            residual: zero(),
            pressures: elements.map(Pressures::new),
            transfer,
            free,
        }
    }

    /// Inverts the diagonal blocks; returns the node whose block is singular, if there is one.
    fn invert(&mut self) -> Result<(), usize> {
        for field in [&mut self.rhs, &mut self.x, &mut self.residual] {
            field.fill(AtNode::default());
        }
        for (node, inverse) in self.inverse.iter_mut().enumerate() {
            *inverse = inverse_of(self.matrix.diagonal(node)).ok_or(node)?;
        }
        if let Some(pressures) = &mut self.pressures {
            pressures.prepare(&self.inverse);
        }
        Ok(())
    }

    /// Makes the matrix of the next coarser level, and the volumes of its elements.
    fn coarsen(&mut self, coarse: &mut Self) {
        T::coarsen(self, &mut coarse.matrix);
        coarse.matrix.hold(&coarse.free, T::OF_DIAGONAL);
        if let (Some(transfer), Some(from)) = (&self.transfer, &self.pressures)
            && let Some(to) = &mut coarse.pressures
        {
            from.coarsen(transfer, &coarse.free, to);
        }
    }

    /// A forward sweep from zero with a correction of pressures, then what it leaves of the right-hand side.
    fn sweep_down(&mut self) {
        let equations = Equations {
            matrix: &self.matrix,
            inverse: &self.inverse,
            rhs: &self.rhs,
        };
        equations.sweep_forward(&mut self.slabs, &mut self.x);
        if let Some(pressures) = &mut self.pressures {
            pressures.p.values.fill(0.0);
            pressures.correct(&mut self.x, &self.inverse, &mut self.residual);
        }
        let is_changed = self.pressures.is_some();
        equations.leave(&self.slabs, is_changed, &self.x, &mut self.residual);
        if let Some(pressures) = &mut self.pressures {
            pressures.subtract_forces(&mut self.residual);
            pressures.leave(&self.x);
        }
    }

    /// Makes what is left the right-hand side of the next coarser level.
    fn restrict(&self, coarse: &mut Self) {
        if let (Some(from), Some(to)) = (&self.pressures, &mut coarse.pressures) {
            from.restrict(to);
        }
        if let Some(transfer) = &self.transfer {
            transfer.restrict(&self.residual, &mut coarse.rhs);
        }
    }

    /// Adds the solution of the next coarser level.
    fn correct(&mut self, coarse: &Self) {
        if let (Some(to), Some(from)) = (&mut self.pressures, &coarse.pressures) {
            to.add_coarse(from);
        }
        if let Some(transfer) = &self.transfer {
            transfer.correct(&mut self.x, &coarse.x);
        }
    }

    /// A backward sweep, under the forces of pressures, and a correction of these.
    fn sweep_up(&mut self) {
        if let Some(pressures) = &self.pressures {
            pressures.subtract_forces(&mut self.rhs);
        }
        let equations = Equations {
            matrix: &self.matrix,
            inverse: &self.inverse,
            rhs: &self.rhs,
        };
        equations.sweep_backward(&mut self.slabs, &mut self.x);
        if let Some(pressures) = &mut self.pressures {
            pressures.correct(&mut self.x, &self.inverse, &mut self.residual);
        }
    }

    /// Calls `visit` with row, column and value of each entry of the matrix of displacements alone, in a fixed order.
    fn visit(&self, visit: &mut dyn FnMut(usize, usize, f64)) {
        let rows = &self.matrix.rows;
        let with_volumes = self.pressures.as_ref().map(|pressures| {
            let blocks = self.matrix.blocks();
            let mut matrix: Vec<NodeBlock> = blocks.map(|block| block.map(f64::from)).collect();
            pressures.add_to(&mut matrix, |row, column| rows.find(row, column));
            matrix
        });
        let blocks = self.matrix.blocks().zip(rows.entries());
        for (number, (block, (node, other))) in blocks.enumerate() {
            let block = match &with_volumes {
                Some(matrix) => matrix[number],
                None => block.map(f64::from),
            };
            for (entry, value) in block.iter().enumerate() {
                let (row, column) = (entry % COMPONENTS, entry / COMPONENTS);
                visit(COMPONENTS * node + row, COMPONENTS * other + column, *value);
            }
        }
    }
}

/// Levels of one part.
#[derive(Debug)]
pub(super) struct Hierarchy<T: Transfer> {
    /// Places of the nodes of the finest level.
    pub(super) nodes: T::Nodes,
    /// Ordered, the finest first.
    pub(super) levels: Vec<Level<T>>,
    coarsest: Direct,
    values: Vec<f64>,
    rhs: Vec<f64>,
}

impl<T: Transfer> Hierarchy<T> {
    /// Of levels without matrices, the finest first.
    pub(super) fn new(nodes: T::Nodes, levels: Vec<Level<T>>) -> Self {
        let last = &levels[levels.len() - 1];
        let size = COMPONENTS * last.free.len();
        let mut entries = Vec::new();
        last.visit(&mut |row, col, _| entries.push((row, col)));
        Self {
            nodes,
            coarsest: Direct::new(size, &entries),
            values: vec![0.0; entries.len()],
            rhs: vec![0.0; size],
            levels,
        }
    }

    /// Makes all coarse matrices from that of the finest level.
    ///
    /// # Errors
    /// A diagonal block or the coarsest matrix is singular.
    pub(super) fn prepare(&mut self) -> Result<(), Singular> {
        for fine in 0..self.levels.len() {
            let (above, below) = self.levels.split_at_mut(fine + 1);
            let level = &mut above[fine];
            level.invert().map_err(|column| Singular { column })?;
            if let Some(coarse) = below.first_mut() {
                level.coarsen(coarse);
            }
        }
        let mut values = self.values.iter_mut();
        self.levels[self.levels.len() - 1].visit(&mut |row, col, found| {
            let value = values.next().expect("entries are those of the pattern");
            *value = match found == 0.0 && row == col {
                true => 1.0,
                false => found,
            };
        });
        self.coarsest.factor(&self.values)
    }

    /// One V-cycle for the right-hand side of the finest level.
    pub(super) fn cycle(&mut self) {
        let coarsest = self.levels.len() - 1;
        for fine in 0..coarsest {
            let (above, below) = self.levels.split_at_mut(fine + 1);
            above[fine].sweep_down();
            above[fine].restrict(&mut below[0]);
        }
        self.solve_coarsest();
        for fine in (0..coarsest).rev() {
            let (above, below) = self.levels.split_at_mut(fine + 1);
            above[fine].correct(&below[0]);
            above[fine].sweep_up();
        }
    }

    fn solve_coarsest(&mut self) {
        let coarsest = self.levels.len() - 1;
        let last = &mut self.levels[coarsest];
        if let Some(pressures) = &mut last.pressures {
            pressures.condense(&mut last.rhs);
        }
        let given = last.rhs.as_flattened();
        for (value, from) in self.rhs.iter_mut().zip(given) {
            *value = f64::from(*from);
        }
        self.coarsest.solve_roughly(&mut self.rhs);
        let found = last.free.iter().zip(self.rhs.chunks_exact(COMPONENTS));
        for (x, (free, found)) in last.x.iter_mut().zip(found) {
            *x = std::array::from_fn(|component| match free & (1 << component) {
                0 => 0.0,
                _ => found[component] as f32,
            });
        }
        if let Some(pressures) = &mut last.pressures {
            pressures.follow(&last.x);
        }
    }

    /// Bytes of all levels.
    pub(super) fn bytes(&self) -> usize {
        let of_level = |level: &Level<T>| {
            let pressures = level.pressures.as_ref();
            let of_pressures = pressures.map_or(0, Pressures::bytes);
            let of_transfer = level.transfer.as_ref().map_or(0, Transfer::blocks);
            let blocks = level.matrix.rows.blocks() + of_transfer + level.free.len();
            size_of::<Block>() * blocks + of_pressures
        };
        self.levels.iter().map(of_level).sum()
    }
}
