//! Levels from the finest to the coarsest, and one V-cycle through them: matrices in single precision and sweeps of block Gauss–Seidel.
//!
//! Entries of blocks are by column. Rows and columns of components with given values are zero.

use crate::sparse::multigrid::node_grid::{
    AtNode, Block, COMPONENTS, Field, NodeBlock, inverse_of,
};
use crate::sparse::multigrid::pressures::{Elements, Pressures};
use crate::sparse::{Direct, Singular};
use std::fmt::Debug;

/// A level of so few nodes is solved directly.
pub(super) const COARSEST: usize = 100;

/// Nodes of a level with their matrix, and the transfer to the next coarser level.
pub(super) trait Nodes: Debug + Sized {
    type Elements: Elements;

    /// Zero at all nodes.
    fn field<T: Copy + Default>(&self) -> Field<T>;

    /// The block on the diagonal of a node.
    fn diagonal(&self, node: usize) -> &Block;

    /// Makes the matrix of the next coarser level, and the volumes of its elements.
    fn coarsen(fine: &mut Level<Self>, coarse: &mut Level<Self>);

    /// A forward sweep from zero.
    fn forward(&mut self, inverse: &[Block], rhs: &Field, x: &mut Field);

    /// Writes what a forward sweep leaves of the right-hand side: neighbours behind have had no part in it, unless the solution was changed
    /// after it.
    fn leave(&self, is_changed: bool, rhs: &Field, x: &Field, residual: &mut Field);

    /// A backward sweep, which reads the matrix backward too.
    fn backward(&mut self, inverse: &[Block], rhs: &Field, x: &mut Field);

    /// Makes a residual the right-hand side of the next coarser level.
    fn restrict(&self, residual: &Field, coarse: &Self, rhs: &mut Field);

    /// Adds the solution of the next coarser level.
    fn correct(&self, x: &mut Field, coarse: &Self, correction: &Field);

    /// The blocks of the matrix in order.
    fn blocks(&self) -> impl Iterator<Item = &Block>;

    /// Number of a block by its row and column.
    fn find(&self, row: usize, column: usize) -> Option<usize>;

    /// Calls `visit` with number, row and column of each block between nodes of the level, and the block.
    fn visit(&self, visit: impl FnMut(usize, [usize; 2], &Block));

    /// Number of blocks that are kept.
    fn count(&self) -> usize;
}

/// A level.
#[derive(Debug)]
pub(super) struct Level<N: Nodes> {
    pub(super) nodes: N,
    /// For each node, a bit for each component without a given value.
    pub(super) free: Vec<u8>,
    /// Inverse of the diagonal blocks; rows and columns of given values are zero.
    pub(super) inverse: Vec<Block>,
    pub(super) rhs: Field,
    pub(super) x: Field,
    pub(super) residual: Field,
    /// Pressures of elements, where they resist changes of volume.
    pub(super) pressures: Option<Pressures<N::Elements>>,
}

impl<N: Nodes> Level<N> {
    /// A level without a matrix.
    pub(super) fn new(nodes: N, free: Vec<u8>, elements: Option<N::Elements>) -> Self {
        Self {
            inverse: vec![Block::default(); free.len()],
            rhs: nodes.field(),
            x: nodes.field(),
            residual: nodes.field(),
            pressures: elements.map(Pressures::new),
            nodes,
            free,
        }
    }

    /// Inverts the diagonal blocks; returns the node whose block is singular, if there is one.
    fn invert(&mut self) -> Result<(), usize> {
        for field in [&mut self.rhs, &mut self.x, &mut self.residual] {
            field.values.fill(AtNode::default());
        }
        for (node, inverse) in self.inverse.iter_mut().enumerate() {
            *inverse = inverse_of(self.nodes.diagonal(node)).ok_or(node)?;
        }
        if let Some(pressures) = &mut self.pressures {
            pressures.prepare(&self.inverse);
        }
        Ok(())
    }

    /// A forward sweep from zero with a correction of pressures, then what it leaves of the right-hand side.
    fn sweep_down(&mut self) {
        self.nodes.forward(&self.inverse, &self.rhs, &mut self.x);
        if let Some(pressures) = &mut self.pressures {
            pressures.p.values.fill(0.0);
            pressures.correct(&mut self.x, &self.inverse, &mut self.residual);
        }
        let is_changed = self.pressures.is_some();
        self.nodes
            .leave(is_changed, &self.rhs, &self.x, &mut self.residual);
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
        self.nodes
            .restrict(&self.residual, &coarse.nodes, &mut coarse.rhs);
    }

    /// Adds the solution of the next coarser level.
    fn correct(&mut self, coarse: &Self) {
        if let (Some(to), Some(from)) = (&mut self.pressures, &coarse.pressures) {
            to.add_coarse(from);
        }
        self.nodes.correct(&mut self.x, &coarse.nodes, &coarse.x);
    }

    /// A backward sweep, under the forces of pressures, and a correction of these.
    fn sweep_up(&mut self) {
        if let Some(pressures) = &self.pressures {
            pressures.subtract_forces(&mut self.rhs);
        }
        self.nodes.backward(&self.inverse, &self.rhs, &mut self.x);
        if let Some(pressures) = &mut self.pressures {
            pressures.correct(&mut self.x, &self.inverse, &mut self.residual);
        }
    }

    /// Calls `visit` with row, column and value of each entry of the matrix of displacements alone, in a fixed order.
    fn visit(&self, visit: &mut dyn FnMut(usize, usize, f64)) {
        let with_volumes = self.pressures.as_ref().map(|pressures| {
            let blocks = self.nodes.blocks();
            let mut matrix: Vec<NodeBlock> = blocks.map(|block| block.map(f64::from)).collect();
            pressures.add_to(&mut matrix, |row, column| self.nodes.find(row, column));
            matrix
        });
        self.nodes.visit(|number, [node, other], block| {
            let block = match &with_volumes {
                Some(matrix) => matrix[number],
                None => block.map(f64::from),
            };
            for (entry, value) in block.iter().enumerate() {
                let (row, column) = (entry % COMPONENTS, entry / COMPONENTS);
                visit(COMPONENTS * node + row, COMPONENTS * other + column, *value);
            }
        });
    }
}

/// Levels of one part.
#[derive(Debug)]
pub(super) struct Hierarchy<N: Nodes> {
    /// Ordered, the finest first.
    pub(super) levels: Vec<Level<N>>,
    coarsest: Direct,
    values: Vec<f64>,
    rhs: Vec<f64>,
}

impl<N: Nodes> Hierarchy<N> {
    /// Of levels without matrices, the finest first.
    pub(super) fn new(levels: Vec<Level<N>>) -> Self {
        let last = &levels[levels.len() - 1];
        let size = COMPONENTS * last.free.len();
        let mut entries = Vec::new();
        last.visit(&mut |row, col, _| entries.push((row, col)));
        Self {
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
                N::coarsen(level, coarse);
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
        let given = last.rhs.nodes().as_flattened();
        for (value, from) in self.rhs.iter_mut().zip(given) {
            *value = f64::from(*from);
        }
        self.coarsest.solve_roughly(&mut self.rhs);
        let found = last.free.iter().zip(self.rhs.chunks_exact(COMPONENTS));
        for (x, (free, found)) in last.x.nodes_mut().iter_mut().zip(found) {
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
        let of_level = |level: &Level<N>| {
            let pressures = level.pressures.as_ref();
            let of_pressures = pressures.map_or(0, |pressures| pressures.elements.bytes());
            size_of::<Block>() * (level.nodes.count() + level.free.len()) + of_pressures
        };
        self.levels.iter().map(of_level).sum()
    }
}
