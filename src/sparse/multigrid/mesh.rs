//! Levels of a mesh without a grid: matrices by rows of blocks, and transfer by smoothed aggregation.

use crate::math::join;
use crate::sparse::multigrid::aggregation::{Aggregation, Points};
use crate::sparse::multigrid::level::{COARSEST, Hierarchy, Level, Nodes};
use crate::sparse::multigrid::mesh_pressures::MeshElements;
use crate::sparse::multigrid::node_grid::{
    AtNode, Block, COMPONENTS, Field, add, add_transposed, free_components, solved,
};
use crate::sparse::multigrid::triangles::{BlockRows, MeshMatrix, NodeMesh};
use std::sync::Arc;

/// Products by which the largest eigenvalue of D⁻¹ A is estimated.
const PRODUCTS: usize = 8;
/// Factor of the inverse of that eigenvalue which damps the smoothing of the transfer.
const DAMPING: f32 = 4.0 / 3.0;
/// Part by which that estimate may be too small.
const SAFE: f32 = 1.05;
/// Relative addition to the diagonal of coarse matrices: aggregates of points on a line turn about it without resistance.
const SHIFT: f32 = 1e-5;

/// The nodes of one level.
#[derive(Debug)]
pub(super) struct Mesh {
    /// Places of its nodes.
    points: Points,
    pub(super) matrix: MeshMatrix,
    /// Transfer to the next coarser level; none of the coarsest.
    transfer: Option<Aggregation>,
}

impl Hierarchy<Mesh> {
    /// The levels of a mesh without matrices.
    pub(super) fn of_mesh(mesh: &NodeMesh) -> Self {
        let rows = BlockRows::of_elements(mesh.places.len(), &mesh.elements);
        let free = mesh.unknowns.iter().map(free_components).collect();
        let elements = (mesh.has_pressures).then(|| MeshElements::of_mesh(mesh));
        Self::from(Arc::new(rows), free, Points::at(&mesh.places), elements)
    }

    /// The levels without matrices of scalars at the nodes of a mesh, a component each; `free` has a bit for each one without a given value.
    pub(super) fn of_scalars(finest: &Mesh, free: Vec<u8>) -> Self {
        let rows = finest.matrix.rows.clone();
        Self::from(rows, free, finest.points.of_scalars(), None)
    }

    fn from(
        mut rows: Arc<BlockRows>,
        mut free: Vec<u8>,
        mut points: Points,
        mut elements: Option<MeshElements>,
    ) -> Self {
        let level = |rows, points, transfer, free, elements| {
            let mesh = Mesh {
                matrix: MeshMatrix::new(rows),
                points,
                transfer,
            };
            Level::new(mesh, free, elements)
        };
        let mut levels = Vec::new();
        while free.len() > COARSEST {
            let aggregates = points.aggregate(&rows, &free);
            let (next, next_free) = (aggregates.points.clone(), aggregates.free.clone());
            // Nothing becomes coarser where no points are coupled.
            if next_free.len() >= free.len() {
                break;
            }
            let (transfer, next_rows) = Aggregation::new(&rows, aggregates);
            let coarse = |of: &mut MeshElements| of.coarse(&transfer, next_free.len());
            let next_elements = elements.as_mut().map(coarse);
            levels.push(level(rows, points, Some(transfer), free, elements));
            (rows, free, points) = (Arc::new(next_rows), next_free, next);
            elements = next_elements;
        }
        // The matrix that is solved directly is that of displacements alone.
        if let Some(elements) = &elements {
            rows = Arc::new(elements.with_nodes_coupled(&rows));
        }
        levels.push(level(rows, points, None, free, elements));
        Self::new(levels)
    }
}

impl Mesh {
    /// Transfer to the next coarser level.
    fn transfer(&self) -> &Aggregation {
        let transfer = self.transfer.as_ref();
        transfer.expect("a coarser level has a transfer")
    }

    /// Product of a row.
    fn product(&self, row: usize, x: &[AtNode]) -> AtNode {
        let mut sum = AtNode::default();
        add_all(&mut sum, self.matrix.lower(row), x);
        add(&mut sum, self.matrix.diagonal(row), &x[row]);
        add_all(&mut sum, self.matrix.upper(row), x);
        sum
    }

    /// Leaves rows and columns of given values out, and makes the matrix regular.
    fn hold(&mut self, free: &[u8]) {
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
}

/// Adds blocks times what they multiply.
#[inline(always)]
fn add_all<'m>(
    sum: &mut AtNode,
    couplings: impl Iterator<Item = (&'m Block, &'m u32)>,
    x: &[AtNode],
) {
    for (block, column) in couplings {
        add(sum, block, &x[*column as usize]);
    }
}

/// Estimates the largest eigenvalue of D⁻¹ A by powers of it.
fn largest(level: &mut Level<Mesh>) -> f32 {
    let (x, residual) = (level.x.nodes_mut(), level.residual.nodes_mut());
    for (node, x) in x.iter_mut().enumerate() {
        *x = std::array::from_fn(|component| match level.free[node] & (1 << component) {
            0 => 0.0,
            _ => (0.7 * (COMPONENTS * node + component) as f32).sin(),
        });
    }
    let mut largest = 1.0;
    for _ in 0..PRODUCTS {
        let before = length(x);
        for (node, (residual, inverse)) in residual.iter_mut().zip(&level.inverse).enumerate() {
            let product = level.nodes.product(node, x);
            *residual = AtNode::default();
            add(residual, inverse, &product);
        }
        let after = length(residual);
        if after == 0.0 || !after.is_finite() {
            break;
        }
        largest = after / before;
        for (x, product) in x.iter_mut().zip(&*residual) {
            *x = product.map(|value| value / after);
        }
    }
    x.fill(AtNode::default());
    largest
}

impl Nodes for Mesh {
    type Elements = MeshElements;

    fn field<T: Copy + Default>(&self) -> Field<T> {
        Field::of_mesh(self.matrix.rows.count())
    }

    fn diagonal(&self, node: usize) -> &Block {
        self.matrix.diagonal(node)
    }

    fn coarsen(fine: &mut Level<Self>, coarse: &mut Level<Self>) {
        let damping = DAMPING / (SAFE * largest(fine));
        let Self {
            matrix, transfer, ..
        } = &mut fine.nodes;
        let transfer = transfer.as_mut().expect("a coarser level has a transfer");
        transfer.prepare(matrix, &fine.inverse, damping, &mut coarse.nodes.matrix);
        coarse.nodes.hold(&coarse.free);
        if let (Some(from), Some(to)) = (&fine.pressures, &mut coarse.pressures) {
            from.coarsen(transfer, &coarse.free, to);
        }
    }

    fn forward(&mut self, inverse: &[Block], rhs: &Field, x: &mut Field) {
        let (x, rhs) = (x.nodes_mut(), rhs.nodes());
        for node in 0..x.len() {
            let mut sum = AtNode::default();
            add_all(&mut sum, self.matrix.lower(node), x);
            x[node] = solved(&inverse[node], &rhs[node], &sum);
        }
    }

    fn leave(&self, is_changed: bool, rhs: &Field, x: &Field, residual: &mut Field) {
        let (x, rhs, residual) = (x.nodes(), rhs.nodes(), residual.nodes_mut());
        let half = residual.len() / 2;
        let (lower, upper) = residual.split_at_mut(half);
        let leave = |first: usize, residual: &mut [AtNode]| {
            for (node, residual) in (first..).zip(residual) {
                *residual = match is_changed {
                    true => {
                        let product = self.product(node, x);
                        std::array::from_fn(|c| rhs[node][c] - product[c])
                    }
                    false => {
                        let mut sum = AtNode::default();
                        add_all(&mut sum, self.matrix.upper(node), x);
                        sum.map(|s| -s)
                    }
                };
            }
        };
        join(|| leave(0, lower), || leave(half, upper));
    }

    fn backward(&mut self, inverse: &[Block], rhs: &Field, x: &mut Field) {
        let (x, rhs) = (x.nodes_mut(), rhs.nodes());
        for node in (0..x.len()).rev() {
            let mut sum = AtNode::default();
            add_all(&mut sum, self.matrix.upper(node).rev(), x);
            add_all(&mut sum, self.matrix.lower(node).rev(), x);
            x[node] = solved(&inverse[node], &rhs[node], &sum);
        }
    }

    fn restrict(&self, residual: &Field, _coarse: &Self, rhs: &mut Field) {
        let (transfer, residual) = (self.transfer(), residual.nodes());
        for (rhs, children) in rhs.nodes_mut().iter_mut().zip(&transfer.children) {
            *rhs = AtNode::default();
            for &[row, block] in children {
                let weights = &transfer.values[block as usize];
                add_transposed(rhs, weights, &residual[row as usize]);
            }
        }
    }

    fn correct(&self, x: &mut Field, _coarse: &Self, correction: &Field) {
        let (transfer, correction) = (self.transfer(), correction.nodes());
        for (node, x) in x.nodes_mut().iter_mut().enumerate() {
            for block in transfer.pattern.range(node) {
                let from = &correction[transfer.pattern.column(block)];
                add(x, &transfer.values[block], from);
            }
        }
    }

    fn blocks(&self) -> impl Iterator<Item = &Block> {
        self.matrix.blocks()
    }

    fn find(&self, row: usize, column: usize) -> Option<usize> {
        self.matrix.rows.find(row, column)
    }

    fn visit(&self, mut visit: impl FnMut(usize, [usize; 2], &Block)) {
        let entries = self.matrix.rows.entries();
        for (number, (block, (row, column))) in self.blocks().zip(entries).enumerate() {
            visit(number, [row, column], block);
        }
    }

    fn count(&self) -> usize {
        let of_transfer = self.transfer.as_ref().map_or(0, Aggregation::blocks);
        self.matrix.rows.blocks() + of_transfer
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
