//! Box grids of nodes, from the finest to the coarsest: trilinear transfer P, Galerkin coarse matrices Pᵀ A P, and sweeps over slabs.

use crate::math::join;
use crate::sparse::multigrid::grid_pressures::GridElements;
use crate::sparse::multigrid::level::{COARSEST, Hierarchy, Level, Nodes};
use crate::sparse::multigrid::node_grid::{
    AtNode, Axis, Block, COMPONENTS, Field, NEIGHBOURS, NodeGrid, OWN, coarsening, free_components,
    indices, neighbour, node_at, offsets,
};
use crate::sparse::multigrid::slab::{Equations, Slab, slabs, split};
use crate::sparse::multigrid::triangles::{Row, Rows, Triangles};

/// The nodes of one grid.
#[derive(Debug)]
pub(super) struct Grid {
    /// Places of the node planes.
    pub(super) planes: [Vec<f64>; 3],
    pub(super) counts: [usize; 3],
    offsets: [isize; NEIGHBOURS],
    pub(super) matrix: Triangles,
    /// Transfer to the next coarser grid; none of the coarsest.
    transfer: Option<[Axis; 3]>,
    slabs: Vec<Slab>,
}

impl Hierarchy<Grid> {
    /// The grids of a box without matrices.
    pub(super) fn of(grid: &NodeGrid) -> Self {
        let free = grid.unknowns.iter().map(free_components).collect();
        Self::between(&grid.planes, free, grid.has_pressures)
    }

    /// The grids between these planes, with a bit for each component of a node without a given value.
    pub(super) fn between(finest: &[Vec<f64>; 3], mut free: Vec<u8>, has_pressures: bool) -> Self {
        let mut planes = finest.clone();
        let mut levels = Vec::new();
        loop {
            let transfer = match free.len() > COARSEST {
                true => coarsening(&planes),
                false => None,
            };
            let Some(axes) = &transfer else {
                levels.push(Grid::level(planes, free, None, has_pressures));
                return Self::new(levels);
            };
            let counts = planes.each_ref().map(Vec::len);
            let next = [0, 1, 2].map(|axis| axes[axis].kept.len());
            let kept = |node: usize| {
                let at = indices(next, node);
                node_at(counts, [0, 1, 2].map(|axis| axes[axis].kept[at[axis]]))
            };
            let coarse = (0..next.iter().product()).map(|node| free[kept(node)]);
            let coarse = coarse.collect();
            let of_axis = |axis: usize| {
                let kept = axes[axis].kept.iter();
                kept.map(|&plane| planes[axis][plane]).collect()
            };
            let coarse_planes = [0, 1, 2].map(of_axis);
            levels.push(Grid::level(planes, free, transfer, has_pressures));
            (planes, free) = (coarse_planes, coarse);
        }
    }
}

impl Grid {
    /// A level of the nodes at these planes without a matrix.
    fn level(
        planes: [Vec<f64>; 3],
        free: Vec<u8>,
        transfer: Option<[Axis; 3]>,
        has_pressures: bool,
    ) -> Level<Self> {
        let counts = planes.each_ref().map(Vec::len);
        let elements = has_pressures.then(|| GridElements::new(counts, transfer.as_ref()));
        let grid = Self {
            planes,
            counts,
            offsets: offsets(counts),
            matrix: Triangles::of_grid(free.len()),
            transfer,
            slabs: slabs(counts),
        };
        Level::new(grid, free, elements)
    }

    /// Transfer to the next coarser grid.
    fn axes(&self) -> &[Axis; 3] {
        let transfer = self.transfer.as_ref();
        transfer.expect("a coarser grid has a transfer")
    }

    fn equations<'a>(&'a self, inverse: &'a [Block], rhs: &'a Field) -> Equations<'a> {
        Equations {
            counts: self.counts,
            offsets: &self.offsets,
            matrix: &self.matrix,
            inverse,
            rhs,
        }
    }

    /// Calls `sweep` with all slabs of one colour, at once.
    fn each(&mut self, is_second: bool, x: &mut Field, sweep: impl Fn(&Self, &mut Slab) + Sync) {
        let (counts, mut slabs) = (self.counts, std::mem::take(&mut self.slabs));
        let of_colour = |slab: &&mut Slab| slab.is_second == is_second;
        for slab in slabs.iter_mut().filter(of_colour) {
            slab.take(counts, x);
        }
        let grid = &*self;
        let mut of_one = slabs.iter_mut().filter(of_colour);
        match (of_one.next(), of_one.next()) {
            (Some(a), Some(b)) => _ = join(|| sweep(grid, a), || sweep(grid, b)),
            (Some(a), None) => sweep(grid, a),
            _ => {}
        }
        for slab in slabs.iter().filter(|slab| slab.is_second == is_second) {
            slab.hand_back(counts, x);
        }
        self.slabs = slabs;
    }
}

impl Nodes for Grid {
    type Elements = GridElements;

    fn field<T: Copy + Default>(&self) -> Field<T> {
        Field::new(self.counts)
    }

    fn diagonal(&self, node: usize) -> &Block {
        self.matrix.diagonal(node)
    }

    fn coarsen(fine: &mut Level<Self>, coarse: &mut Level<Self>) {
        let (grid, axes) = (&fine.nodes, fine.nodes.axes());
        let half = coarse.free.len() / 2;
        let (counts, free) = (coarse.nodes.counts, &coarse.free);
        let rows = coarse.nodes.matrix.rows_mut();
        let [below, above] = rows.split_at(half, [OWN * half; 2]);
        join(
            || coarse_rows(grid, axes, counts, free, 0, below),
            || coarse_rows(grid, axes, counts, free, half, above),
        );
        if let (Some(from), Some(to)) = (&fine.pressures, &mut coarse.pressures) {
            from.coarsen(axes, free, to);
        }
    }

    fn forward(&mut self, inverse: &[Block], rhs: &Field, x: &mut Field) {
        for is_second in [false, true] {
            self.each(is_second, x, |grid, slab| {
                grid.equations(inverse, rhs).forward(slab);
            });
        }
    }

    fn leave(&self, is_changed: bool, rhs: &Field, x: &Field, residual: &mut Field) {
        let (counts, equations) = (self.counts, self.equations(&[], rhs));
        let (lower, upper) = self.slabs.split_at(self.slabs.len() / 2);
        let nodes = upper[0].first_node(counts);
        let (below, above) = residual.nodes_mut().split_at_mut(nodes);
        let leave = |slabs: &[Slab], residual: &mut [AtNode]| {
            for (slab, residual) in split(slabs, counts, residual) {
                match is_changed {
                    true => equations.leave_all(slab, x, residual),
                    false => equations.leave(slab, x, residual),
                }
            }
        };
        match lower.is_empty() {
            true => leave(upper, above),
            false => _ = join(|| leave(lower, below), || leave(upper, above)),
        }
    }

    fn backward(&mut self, inverse: &[Block], rhs: &Field, x: &mut Field) {
        for is_second in [true, false] {
            self.each(is_second, x, |grid, slab| {
                grid.equations(inverse, rhs).backward(slab);
            });
        }
    }

    fn restrict(&self, residual: &Field, coarse: &Self, rhs: &mut Field) {
        let (axes, residual) = (self.axes(), residual.nodes());
        for (node, rhs) in rhs.nodes_mut().iter_mut().enumerate() {
            let at = indices(coarse.counts, node);
            let children = [0, 1, 2].map(|axis| &axes[axis].children[at[axis]]);
            *rhs = AtNode::default();
            for &(z, weight_z) in children[2] {
                for &(y, weight_y) in children[1] {
                    for &(x, weight_x) in children[0] {
                        let weight = weight_x * weight_y * weight_z;
                        let from = &residual[node_at(self.counts, [x, y, z])];
                        for (sum, value) in rhs.iter_mut().zip(from) {
                            *sum += weight * value;
                        }
                    }
                }
            }
        }
    }

    fn correct(&self, x: &mut Field, coarse: &Self, correction: &Field) {
        let correction = correction.nodes();
        for (node, x) in x.nodes_mut().iter_mut().enumerate() {
            for (parent, weight) in parents(self.axes(), indices(self.counts, node)) {
                let from = &correction[node_at(coarse.counts, parent)];
                for (x, value) in x.iter_mut().zip(from) {
                    *x += weight * value;
                }
            }
        }
    }

    fn blocks(&self) -> impl Iterator<Item = &Block> {
        let nodes = 0..self.counts.iter().product();
        nodes.flat_map(|node| self.matrix.grid_row(node))
    }

    fn find(&self, row: usize, column: usize) -> Option<usize> {
        let [of, other] = [row, column].map(|node| indices(self.counts, node));
        neighbour(of, other).map(|place| NEIGHBOURS * row + place)
    }

    fn visit(&self, mut visit: impl FnMut(usize, [usize; 2], &Block)) {
        for (number, block) in self.blocks().enumerate() {
            let (node, neighbour) = (number / NEIGHBOURS, number % NEIGHBOURS);
            if is_inside(self.counts, node, neighbour) {
                let other = (node as isize + self.offsets[neighbour]) as usize;
                visit(number, [node, other], block);
            }
        }
    }

    fn count(&self) -> usize {
        self.matrix.blocks()
    }
}

/// Returns true if a neighbour of a node is a node of the grid.
fn is_inside(counts: [usize; 3], node: usize, neighbour: usize) -> bool {
    let at = indices(counts, node);
    let step = |axis: usize, divisor: usize| {
        let there = at[axis] + neighbour / divisor % 3;
        (1..=counts[axis]).contains(&there)
    };
    step(0, 1) && step(1, 3) && step(2, 9)
}

/// Most fine planes that a coarse node and its neighbours of the fine grid are in, along an axis.
const REACH: usize = 5;

#[inline(always)]
fn add_scaled(sum: &mut Block, weight: f32, block: &Block) {
    for (sum, entry) in sum.iter_mut().zip(block) {
        *sum += weight * entry;
    }
}

/// Rows of a coarse matrix from a node on.
fn coarse_rows(
    fine: &Grid,
    axes: &[Axis; 3],
    counts: [usize; 3],
    free: &[u8],
    first: usize,
    matrix: Rows<'_>,
) {
    let offsets = offsets(counts);
    matrix.write(|place, blocks| {
        let node = first + place;
        coarse_row(fine, axes, indices(counts, node), blocks);
        // Values that are given on the coarse grid.
        for (block, offset) in blocks.iter_mut().zip(&offsets) {
            let other = (node as isize + offset) as usize;
            let columns = free.get(other).copied().unwrap_or_default();
            for (col, entries) in block.chunks_exact_mut(COMPONENTS).enumerate() {
                for (row, entry) in entries.iter_mut().enumerate() {
                    if columns & (1 << col) == 0 || free[node] & (1 << row) == 0 {
                        *entry = 0.0;
                    }
                }
            }
        }
    });
}

/// One row of a coarse matrix.
fn coarse_row(fine: &Grid, axes: &[Axis; 3], at: [usize; 3], blocks: &mut Row) {
    let children = [0, 1, 2].map(|axis| &axes[axis].children[at[axis]]);
    let first = children.map(|list| list[0].0.saturating_sub(1));
    let mut sums = [Block::default(); REACH * REACH * REACH];
    for &(z, weight_z) in children[2] {
        for &(y, weight_y) in children[1] {
            for &(x, weight_x) in children[0] {
                let own = node_at(fine.counts, [x, y, z]);
                let weight = weight_x * weight_y * weight_z;
                for (place, block) in fine.matrix.grid_row(own).enumerate() {
                    let step = |i: usize, divisor: usize, axis: usize| {
                        let there = (i + place / divisor % 3).checked_sub(1)?;
                        (there < fine.counts[axis]).then(|| there - first[axis])
                    };
                    if let (Some(x), Some(y), Some(z)) =
                        (step(x, 1, 0), step(y, 3, 1), step(z, 9, 2))
                    {
                        add_scaled(&mut sums[x + REACH * (y + REACH * z)], weight, block);
                    }
                }
            }
        }
    }
    let last = [0, 1, 2].map(|axis| {
        let list = children[axis];
        (list[list.len() - 1].0 + 1).min(fine.counts[axis] - 1)
    });
    blocks.fill(Block::default());
    for z in first[2]..=last[2] {
        for y in first[1]..=last[1] {
            for x in first[0]..=last[0] {
                let [i, j, k] = [x - first[0], y - first[1], z - first[2]];
                let sum = &sums[i + REACH * (j + REACH * k)];
                for (parent, weight) in parents(axes, [x, y, z]) {
                    let place = neighbour(at, parent).expect("parents are neighbours");
                    add_scaled(&mut blocks[place], weight, sum);
                }
            }
        }
    }
}

/// Coarse nodes from which a node is interpolated, with weights.
fn parents(axes: &[Axis; 3], at: [usize; 3]) -> impl Iterator<Item = ([usize; 3], f32)> {
    let of = [0, 1, 2].map(|axis| axes[axis].parents[at[axis]]);
    (0..8).filter_map(move |corner| {
        let [x, y, z] = [0, 1, 2].map(|axis| of[axis][corner >> axis & 1]);
        let weight = x.1 * y.1 * z.1;
        (weight > 0.0).then_some(([x.0, y.0, z.0], weight))
    })
}
