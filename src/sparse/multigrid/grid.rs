//! Box grids of nodes, from the finest to the coarsest: trilinear transfer P, and Galerkin coarse matrices Pᵀ A P.

use crate::sparse::multigrid::grid_pressures::GridElements;
use crate::sparse::multigrid::level::{COARSEST, Hierarchy, Level, Transfer};
use crate::sparse::multigrid::node_grid::{
    AtNode, Axis, Block, NodeGrid, coarsening, free_components, indices, near, node_at,
};
use crate::sparse::multigrid::pressures::Interpolation;
use crate::sparse::multigrid::slab::Slab;
use crate::sparse::multigrid::triangles::{BlockMatrix, BlockRows, Marks};
use std::sync::Arc;

/// Transfer to the next coarser grid.
#[derive(Debug)]
pub(super) struct Trilinear {
    axes: [Axis; 3],
    /// Planes of the fine and of the coarse grid along each axis.
    fine: [usize; 3],
    coarse: [usize; 3],
    /// Work space of either half of the coarse rows.
    marks: [Marks; 2],
}

impl Hierarchy<Trilinear> {
    /// The grids of a box without matrices.
    pub(super) fn of(grid: &NodeGrid) -> Self {
        let free = grid.unknowns.iter().map(free_components).collect();
        let rows = Arc::new(BlockRows::of_box(grid.counts()));
        Self::between(&grid.planes, rows, free, grid.has_pressures)
    }

    /// The grids between these planes, with a bit for each component of a node without a given value.
    pub(super) fn between(
        finest: &[Vec<f64>; 3],
        mut rows: Arc<BlockRows>,
        mut free: Vec<u8>,
        has_pressures: bool,
    ) -> Self {
        let mut planes = finest.clone();
        let mut levels = Vec::new();
        loop {
            let axes = match free.len() > COARSEST {
                true => coarsening(&planes),
                false => None,
            };
            let counts = planes.each_ref().map(Vec::len);
            let elements = has_pressures.then(|| GridElements::new(counts, axes.as_ref()));
            let slabs = Slab::of_box(counts);
            let Some(axes) = axes else {
                levels.push(Level::new(rows, slabs, free, None, elements));
                return Self::new(finest.clone(), levels);
            };
            let coarse = axes.each_ref().map(|axis| axis.kept.len());
            let of_coarse = (0..coarse.iter().product()).map(|node| {
                let at = indices(coarse, node);
                free[node_at(counts, [0, 1, 2].map(|axis| axes[axis].kept[at[axis]]))]
            });
            let of_coarse: Vec<u8> = of_coarse.collect();
            let of_axis = |axis: usize| {
                let kept = axes[axis].kept.iter();
                kept.map(|&plane| planes[axis][plane]).collect()
            };
            planes = [0, 1, 2].map(of_axis);
            let transfer = Trilinear {
                marks: Marks::of_halves(of_coarse.len()),
                fine: counts,
                coarse,
                axes,
            };
            levels.push(Level::new(rows, slabs, free, Some(transfer), elements));
            (rows, free) = (Arc::new(BlockRows::of_box(coarse)), of_coarse);
        }
    }
}

impl Transfer for Trilinear {
    type Elements = GridElements;
    type Nodes = [Vec<f64>; 3];
    const OF_DIAGONAL: f32 = 1.0;

    fn coarsen(fine: &mut Level<Self>, coarse: &mut BlockMatrix) {
        let transfer = fine.transfer.as_mut();
        let transfer = transfer.expect("a coarser grid has a transfer");
        let mut marks = std::mem::take(&mut transfer.marks);
        coarse.write_rows(&mut marks, |row, blocks, places| {
            transfer.coarse_row(&fine.matrix, row, blocks, places);
        });
        transfer.marks = marks;
    }

    fn restrict(&self, residual: &[AtNode], rhs: &mut [AtNode]) {
        for (node, rhs) in rhs.iter_mut().enumerate() {
            *rhs = AtNode::default();
            self.each_child(node, |at, weight| {
                let from = &residual[node_at(self.fine, at)];
                for (sum, value) in rhs.iter_mut().zip(from) {
                    *sum += weight * value;
                }
            });
        }
    }

    fn correct(&self, x: &mut [AtNode], correction: &[AtNode]) {
        for (node, x) in x.iter_mut().enumerate() {
            for (parent, weight) in self.parents(indices(self.fine, node)) {
                for (x, value) in x.iter_mut().zip(&correction[parent]) {
                    *x += weight * value;
                }
            }
        }
    }

    fn blocks(&self) -> usize {
        0
    }
}

impl Interpolation for Trilinear {
    fn each_parent(&self, node: usize, slopes: &AtNode, mut visit: impl FnMut(usize, AtNode)) {
        for (parent, weight) in self.parents(indices(self.fine, node)) {
            visit(parent, slopes.map(|slope| weight * slope));
        }
    }
}

/// Most fine planes that a coarse node and its neighbours of the fine grid are in, along an axis.
const REACH: usize = 5;

#[inline(always)]
fn add_scaled(sum: &mut Block, weight: f32, block: &Block) {
    for (sum, entry) in sum.iter_mut().zip(block) {
        *sum += weight * entry;
    }
}

impl Trilinear {
    /// Calls `visit` with the indices of each fine node that is interpolated from a coarse one, and the weight.
    #[inline(always)]
    fn each_child(&self, coarse: usize, mut visit: impl FnMut([usize; 3], f32)) {
        let at = indices(self.coarse, coarse);
        let [of_x, of_y, of_z] = [0, 1, 2].map(|axis| &self.axes[axis].children[at[axis]]);
        for &(z, weight_z) in of_z {
            for &(y, weight_y) in of_y {
                for &(x, weight_x) in of_x {
                    visit([x, y, z], weight_x * weight_y * weight_z);
                }
            }
        }
    }

    /// Coarse nodes from which a node is interpolated, with weights.
    fn parents(&self, at: [usize; 3]) -> impl Iterator<Item = (usize, f32)> {
        let of = [0, 1, 2].map(|axis| self.axes[axis].parents[at[axis]]);
        (0..8).filter_map(move |corner| {
            let [x, y, z] = [0, 1, 2].map(|axis| of[axis][corner >> axis & 1]);
            let weight = x.1 * y.1 * z.1;
            (weight > 0.0).then(|| (node_at(self.coarse, [x.0, y.0, z.0]), weight))
        })
    }

    /// Adds one row of the coarse matrix, with the place of each of its columns.
    fn coarse_row(&self, fine: &BlockMatrix, row: usize, blocks: &mut [Block], places: &[u32]) {
        let at = indices(self.coarse, row);
        let reach = [0, 1, 2].map(|axis| {
            let children = &self.axes[axis].children[at[axis]];
            let [first, last] = [0, children.len() - 1].map(|child| children[child].0);
            first.saturating_sub(1)..self.fine[axis].min(last + 2)
        });
        let first = reach.each_ref().map(|planes| planes.start);
        let sum_at = |x: usize, y: usize, z: usize| {
            x - first[0] + REACH * (y - first[1] + REACH * (z - first[2]))
        };
        let mut sums = [Block::default(); REACH * REACH * REACH];
        self.each_child(row, |child, weight| {
            let mut own = fine.row(node_at(self.fine, child));
            let [of_x, of_y, of_z] = [0, 1, 2].map(|axis| near(self.fine[axis], child[axis]));
            for z in of_z {
                for y in of_y.clone() {
                    for (x, block) in of_x.clone().zip(&mut own) {
                        add_scaled(&mut sums[sum_at(x, y, z)], weight, block);
                    }
                }
            }
        });
        let [of_x, of_y, of_z] = reach;
        for z in of_z {
            for y in of_y.clone() {
                for x in of_x.clone() {
                    let sum = &sums[sum_at(x, y, z)];
                    for (parent, weight) in self.parents([x, y, z]) {
                        add_scaled(&mut blocks[places[parent] as usize], weight, sum);
                    }
                }
            }
        }
    }
}
