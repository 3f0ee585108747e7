//! One level of a mesh without a grid: its matrix in single precision by rows of blocks, and the sweeps of block Gauss–Seidel.

use crate::math::join;
use crate::sparse::multigrid::aggregates::Points;
use crate::sparse::multigrid::aggregation::Aggregation;
use crate::sparse::multigrid::block_rows::BlockRows;
use crate::sparse::multigrid::hierarchy::{COARSEST, Hierarchy};
use crate::sparse::multigrid::mesh_matrix::MeshMatrix;
use crate::sparse::multigrid::mesh_pressures::MeshPressures;
use crate::sparse::multigrid::node_grid::{
    Block, COMPONENTS, GridLevel, add, add_transposed, free_components, inverse_of,
};
use crate::sparse::multigrid::triangles::NodeMesh;
use std::sync::Arc;

/// Products by which the largest eigenvalue of D⁻¹ A is estimated.
const PRODUCTS: usize = 8;
/// Factor of the inverse of that eigenvalue which damps the smoothing of the transfer.
const DAMPING: f32 = 4.0 / 3.0;
/// Part by which that estimate may be too small.
const SAFE: f32 = 1.05;
/// Relative addition to the diagonal of coarse matrices: aggregates of points on a line turn about it without resistance.
const SHIFT: f32 = 1e-5;

/// Values of the components of a node.
type AtNode = [f32; COMPONENTS];

/// A level of the hierarchy.
#[derive(Debug)]
pub(super) struct MeshLevel {
    /// Places of its nodes.
    points: Points,
    /// For each node, a bit for each component without a given value.
    pub(super) free: Vec<u8>,
    pub(super) matrix: MeshMatrix,
    inverse: Vec<Block>,
    /// Transfer to the next coarser level; none of the coarsest.
    transfer: Option<Aggregation>,
    pub(super) rhs: Vec<AtNode>,
    pub(super) x: Vec<AtNode>,
    residual: Vec<AtNode>,
    /// Pressures, where elements resist changes of volume.
    pub(super) pressures: Option<MeshPressures>,
}

impl Hierarchy<MeshLevel> {
    /// The levels of a mesh without matrices.
    pub(super) fn of_mesh(mesh: &NodeMesh) -> Self {
        let rows = BlockRows::of_elements(mesh.places.len(), &mesh.elements);
        let free = mesh.unknowns.iter().map(free_components).collect();
        let pressures = (mesh.has_pressures).then(|| MeshPressures::of_elements(mesh));
        Self::from((Arc::new(rows), free), Points::at(&mesh.places), pressures)
    }

    /// The levels without matrices of scalars at the nodes of a level, a component each; `free` has a bit for each one without a given value.
    pub(super) fn of_scalars(finest: &MeshLevel, free: Vec<u8>) -> Self {
        Self::from(
            (finest.matrix.rows.clone(), free),
            finest.points.of_scalars(),
            None,
        )
    }

    fn from(
        (mut rows, mut free): (Arc<BlockRows>, Vec<u8>),
        mut points: Points,
        mut pressures: Option<MeshPressures>,
    ) -> Self {
        let mut levels = Vec::new();
        while free.len() > COARSEST {
            let aggregates = points.aggregate(&rows, &free);
            let (next, next_free) = (aggregates.points.clone(), aggregates.free.clone());
            // Nothing becomes coarser where no points are coupled.
            if next_free.len() >= free.len() {
                break;
            }
            let (transfer, next_rows) = Aggregation::new(&rows, aggregates);
            let coarse = |of: &mut MeshPressures| of.coarse(&transfer, next_free.len());
            let next_pressures = pressures.as_mut().map(coarse);
            levels.push(MeshLevel::new(
                (rows, points),
                free,
                Some(transfer),
                pressures,
            ));
            (rows, free, points) = (Arc::new(next_rows), next_free, next);
            pressures = next_pressures;
        }
        // The matrix that is solved directly is that of displacements alone.
        if let Some(pressures) = &pressures {
            rows = Arc::new(pressures.couple(&rows));
        }
        levels.push(MeshLevel::new((rows, points), free, None, pressures));
        Self::new(levels)
    }
}

impl MeshLevel {
    fn new(
        (rows, points): (Arc<BlockRows>, Points),
        free: Vec<u8>,
        transfer: Option<Aggregation>,
        pressures: Option<MeshPressures>,
    ) -> Self {
        let nodes = free.len();
        Self {
            matrix: MeshMatrix::new(rows),
            inverse: vec![Block::default(); nodes],
            rhs: vec![AtNode::default(); nodes],
            x: vec![AtNode::default(); nodes],
            residual: vec![AtNode::default(); nodes],
            points,
            free,
            transfer,
            pressures,
        }
    }

    /// Corrects pressures behind a sweep, from zero or from those there are; returns false where there are none.
    fn correct_pressures(&mut self, is_from_zero: bool) -> bool {
        let Some(pressures) = &mut self.pressures else {
            return false;
        };
        if is_from_zero {
            pressures.p.fill(0.0);
        }
        pressures.correct(&mut self.x, &self.inverse, &mut self.residual);
        true
    }

    /// Adds blocks times what they multiply.
    #[inline(always)]
    fn add_all<'m>(&self, sum: &mut AtNode, couplings: impl Iterator<Item = (&'m Block, &'m u32)>) {
        for (block, column) in couplings {
            add(sum, block, &self.x[*column as usize]);
        }
    }

    /// Product of a row.
    fn product(&self, row: usize) -> AtNode {
        let mut sum = AtNode::default();
        self.add_all(&mut sum, self.matrix.lower(row));
        add(&mut sum, self.matrix.diagonal(row), &self.x[row]);
        self.add_all(&mut sum, self.matrix.upper(row));
        sum
    }

    /// Estimates the largest eigenvalue of D⁻¹ A by powers of it.
    fn largest(&mut self) -> f32 {
        for (node, x) in self.x.iter_mut().enumerate() {
            *x = std::array::from_fn(|component| match self.free[node] & (1 << component) {
                0 => 0.0,
                _ => (0.7 * (COMPONENTS * node + component) as f32).sin(),
            });
        }
        let mut largest = 1.0;
        for _ in 0..PRODUCTS {
            let before = length(&self.x);
            for node in 0..self.x.len() {
                let product = self.product(node);
                self.residual[node] = AtNode::default();
                add(&mut self.residual[node], &self.inverse[node], &product);
            }
            let after = length(&self.residual);
            if after == 0.0 || !after.is_finite() {
                break;
            }
            largest = after / before;
            for (x, product) in self.x.iter_mut().zip(&self.residual) {
                *x = product.map(|value| value / after);
            }
        }
        self.x.fill(AtNode::default());
        largest
    }

    /// Leaves rows and columns of given values out, and makes the matrix regular.
    fn hold(&mut self) {
        let free = &self.free;
        self.matrix.each_mut(|row, column, block| {
            for (entry, value) in block.iter_mut().enumerate() {
                let at = [entry % COMPONENTS, entry / COMPONENTS];
                if free[row] & 1 << at[0] == 0 || free[column] & 1 << at[1] == 0 {
                    *value = 0.0;
                } else if row == column && at[0] == at[1] {
                    *value *= 1.0 + SHIFT;
                }
            }
        });
    }

    /// Solves the equations of a node, of which its neighbours have this sum.
    #[inline(always)]
    fn solve(&mut self, node: usize, sum: AtNode) {
        let left: AtNode = std::array::from_fn(|c| self.rhs[node][c] - sum[c]);
        self.x[node] = AtNode::default();
        add(&mut self.x[node], &self.inverse[node], &left);
    }
}

impl GridLevel for MeshLevel {
    fn invert(&mut self) -> Result<(), usize> {
        for (node, inverse) in self.inverse.iter_mut().enumerate() {
            *inverse = inverse_of(self.matrix.diagonal(node)).ok_or(node)?;
        }
        if let Some(pressures) = &mut self.pressures {
            pressures.prepare(&self.inverse);
        }
        Ok(())
    }

    fn coarsen(&mut self, coarse: &mut Self) {
        let damping = DAMPING / (SAFE * self.largest());
        let transfer = self.transfer.as_mut();
        let transfer = transfer.expect("a coarser level has a transfer");
        transfer.prepare(&self.matrix, &self.inverse, damping, &mut coarse.matrix);
        coarse.hold();
        if let (Some(from), Some(to)) = (&self.pressures, &mut coarse.pressures) {
            from.coarsen(transfer, &coarse.free, to);
        }
    }

    fn sweep_down(&mut self) {
        for node in 0..self.x.len() {
            let mut sum = AtNode::default();
            self.add_all(&mut sum, self.matrix.lower(node));
            self.solve(node, sum);
        }
        let has_pressures = self.correct_pressures(true);
        let half = self.residual.len() / 2;
        let mut residual = std::mem::take(&mut self.residual);
        let (lower, upper) = residual.split_at_mut(half);
        let leave = |first: usize, residual: &mut [AtNode]| {
            for (node, residual) in (first..).zip(residual) {
                // The neighbours behind alone had no part in the sweep, unless displacements were corrected.
                *residual = match has_pressures {
                    true => {
                        let (rhs, product) = (self.rhs[node], self.product(node));
                        std::array::from_fn(|c| rhs[c] - product[c])
                    }
                    false => {
                        let mut sum = AtNode::default();
                        self.add_all(&mut sum, self.matrix.upper(node));
                        sum.map(|s| -s)
                    }
                };
            }
        };
        join(|| leave(0, lower), || leave(half, upper));
        self.residual = residual;
        if let Some(pressures) = &mut self.pressures {
            pressures.add_forces(&pressures.p, -1.0, &mut self.residual);
            pressures.leave(&self.x);
        }
    }

    fn restrict(&self, coarse: &mut Self) {
        if let (Some(from), Some(to)) = (&self.pressures, &mut coarse.pressures) {
            from.restrict(to);
        }
        let transfer = self.transfer.as_ref();
        let transfer = transfer.expect("a coarser level has a transfer");
        for (rhs, children) in coarse.rhs.iter_mut().zip(&transfer.children) {
            *rhs = AtNode::default();
            for &[row, block] in children {
                let weights = &transfer.values[block as usize];
                add_transposed(rhs, weights, &self.residual[row as usize]);
            }
        }
    }

    fn correct(&mut self, coarse: &Self) {
        if let (Some(to), Some(from)) = (&mut self.pressures, &coarse.pressures) {
            to.add_coarse(from);
        }
        let transfer = self.transfer.as_ref();
        let transfer = transfer.expect("a coarser level has a transfer");
        for (node, x) in self.x.iter_mut().enumerate() {
            for block in transfer.pattern.range(node) {
                let from = &coarse.x[transfer.pattern.column(block)];
                add(x, &transfer.values[block], from);
            }
        }
    }

    fn sweep_up(&mut self) {
        if let Some(pressures) = &self.pressures {
            pressures.add_forces(&pressures.p, -1.0, &mut self.rhs);
        }
        for node in (0..self.x.len()).rev() {
            // The matrix is read backward too.
            let mut sum = AtNode::default();
            self.add_all(&mut sum, self.matrix.upper(node).rev());
            self.add_all(&mut sum, self.matrix.lower(node).rev());
            self.solve(node, sum);
        }
        self.correct_pressures(false);
    }

    fn free(&self) -> &[u8] {
        &self.free
    }

    fn condensed_rhs(&mut self) -> &[AtNode] {
        if let Some(pressures) = &mut self.pressures {
            pressures.condense(&mut self.rhs);
        }
        &self.rhs
    }

    fn take_solution(&mut self, found: impl Iterator<Item = AtNode>) {
        for ((x, free), from) in self.x.iter_mut().zip(&self.free).zip(found) {
            *x = std::array::from_fn(|component| match free & (1 << component) {
                0 => 0.0,
                _ => from[component],
            });
        }
        if let Some(pressures) = &mut self.pressures {
            pressures.follow(&self.x);
        }
    }

    fn visit(&self, visit: &mut dyn FnMut(usize, usize, f64)) {
        let mut matrix = Vec::with_capacity(self.matrix.rows.blocks());
        matrix.extend(self.matrix.blocks().map(|block| block.map(f64::from)));
        if let Some(pressures) = &self.pressures {
            pressures.add_to(&self.matrix.rows, &mut matrix);
        }
        for (block, (node, other)) in matrix.iter().zip(self.matrix.rows.entries()) {
            for (entry, value) in block.iter().enumerate() {
                let (row, column) = (entry % COMPONENTS, entry / COMPONENTS);
                visit(COMPONENTS * node + row, COMPONENTS * other + column, *value);
            }
        }
    }

    fn bytes(&self) -> usize {
        let of_transfer = self.transfer.as_ref().map_or(0, Aggregation::blocks);
        let of_pressures = self.pressures.as_ref().map_or(0, MeshPressures::bytes);
        size_of::<Block>() * (self.matrix.rows.blocks() + self.free.len() + of_transfer)
            + of_pressures
    }
}

/// Length of a vector, in a fixed order of sums.
fn length(x: &[AtNode]) -> f32 {
    let squares = x
        .as_flattened()
        .iter()
        .map(|&value| f64::from(value).powi(2));
    squares.sum::<f64>().sqrt() as f32
}
