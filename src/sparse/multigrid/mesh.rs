//! Levels of a mesh without a grid: matrices by rows of blocks, and transfer by smoothed aggregation.

use crate::sparse::multigrid::aggregation::{Aggregation, Points};
use crate::sparse::multigrid::level::{COARSEST, Hierarchy, Level, Transfer};
use crate::sparse::multigrid::mesh_pressures::MeshElements;
use crate::sparse::multigrid::node_grid::{
    AtNode, COMPONENTS, add, add_transposed, free_components,
};
use crate::sparse::multigrid::pressures::Interpolation;
use crate::sparse::multigrid::slab::Slab;
use crate::sparse::multigrid::triangles::{BlockMatrix, BlockRows, NodeMesh};
use std::sync::Arc;

/// Products by which the largest eigenvalue of D⁻¹ A is estimated.
const PRODUCTS: usize = 8;
/// Factor of the inverse of that eigenvalue which damps the smoothing of the transfer.
const DAMPING: f32 = 4.0 / 3.0;
/// Part by which that estimate may be too small.
const SAFE: f32 = 1.05;
/// Relative addition to the diagonal of coarse matrices: aggregates of points on a line turn about it without resistance.
const SHIFT: f32 = 1e-5;

impl Hierarchy<Aggregation> {
    /// The levels of a mesh without matrices.
    pub(super) fn of_mesh(mesh: &NodeMesh) -> Self {
        let rows = BlockRows::of_elements(mesh.places.len(), &mesh.elements);
        let free = mesh.unknowns.iter().map(free_components).collect();
        let elements = (mesh.has_pressures).then(|| MeshElements::of_mesh(mesh));
        Self::from(Arc::new(rows), free, Points::at(&mesh.places), elements)
    }

    /// The levels without matrices of scalars at the nodes of a mesh, a component each; `free` has a bit for each one without a given value.
    pub(super) fn of_scalars(&self, free: Vec<u8>) -> Self {
        let rows = self.levels[0].matrix.rows.clone();
        Self::from(rows, free, self.nodes.of_scalars(), None)
    }

    fn from(
        mut rows: Arc<BlockRows>,
        mut free: Vec<u8>,
        finest: Points,
        mut elements: Option<MeshElements>,
    ) -> Self {
        let mut points = finest.clone();
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
            let slabs = Slab::whole(free.len());
            levels.push(Level::new(rows, slabs, free, Some(transfer), elements));
            (rows, free, points) = (Arc::new(next_rows), next_free, next);
            elements = next_elements;
        }
        // The matrix that is solved directly is that of displacements alone.
        if let Some(elements) = &elements {
            rows = Arc::new(elements.with_nodes_coupled(&rows));
        }
        let slabs = Slab::whole(free.len());
        levels.push(Level::new(rows, slabs, free, None, elements));
        Self::new(finest, levels)
    }
}

/// Estimates the largest eigenvalue of D⁻¹ A by powers of it.
fn largest(level: &mut Level<Aggregation>) -> f32 {
    let (x, residual) = (&mut level.x, &mut level.residual);
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
            let product = level.matrix.product(node, x);
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

impl Transfer for Aggregation {
    type Elements = MeshElements;
    type Nodes = Points;
    const OF_DIAGONAL: f32 = 1.0 + SHIFT;

    fn coarsen(fine: &mut Level<Self>, coarse: &mut BlockMatrix) {
        let damping = DAMPING / (SAFE * largest(fine));
        let transfer = fine.transfer.as_mut();
        let transfer = transfer.expect("a coarser level has a transfer");
        transfer.prepare(&fine.matrix, &fine.inverse, damping, coarse);
    }

    fn restrict(&self, residual: &[AtNode], rhs: &mut [AtNode]) {
        for (rhs, children) in rhs.iter_mut().zip(&self.children) {
            *rhs = AtNode::default();
            for &[row, block] in children {
                let weights = &self.values[block as usize];
                add_transposed(rhs, weights, &residual[row as usize]);
            }
        }
    }

    fn correct(&self, x: &mut [AtNode], correction: &[AtNode]) {
        for (node, x) in x.iter_mut().enumerate() {
            for block in self.pattern.range(node) {
                let from = &correction[self.pattern.column(block)];
                add(x, &self.values[block], from);
            }
        }
    }

    fn blocks(&self) -> usize {
        self.values.len() + self.of_products.len() + 2 * self.rigid.len()
    }
}

impl Interpolation for Aggregation {
    fn each_parent(&self, node: usize, slopes: &AtNode, mut visit: impl FnMut(usize, AtNode)) {
        for block in self.pattern.range(node) {
            let mut moved = AtNode::default();
            add_transposed(&mut moved, &self.values[block], slopes);
            visit(self.pattern.column(block), moved);
        }
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
