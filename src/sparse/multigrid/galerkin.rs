//! Galerkin coarse matrices Pᵀ A P of trilinear interpolation P, and the transfer of vectors.

use crate::math::join;
use crate::sparse::multigrid::axis::Axis;
use crate::sparse::multigrid::level::Level;
use crate::sparse::multigrid::node_grid::{
    Block, COMPONENTS, OWN, indices, neighbour, node_at, offsets,
};
use crate::sparse::multigrid::triangles::{Row, Rows};

/// Most fine planes that a coarse node and its neighbours of the fine grid are in, along an axis.
const REACH: usize = 5;

#[inline(always)]
fn add_scaled(sum: &mut Block, weight: f32, block: &Block) {
    for (sum, entry) in sum.iter_mut().zip(block) {
        *sum += weight * entry;
    }
}

/// Makes the matrix of a coarse grid from that of the next finer one.
pub(super) fn coarse_matrix(fine: &Level, coarse: &mut Level) {
    let axes = fine
        .transfer
        .as_ref()
        .expect("a coarser grid has a transfer");
    let half = coarse.free.len() / 2;
    let (counts, free) = (coarse.counts, &coarse.free);
    let [below, above] = coarse.matrix.rows_mut().split_at(half, [OWN * half; 2]);
    join(
        || rows(fine, axes, counts, free, 0, below),
        || rows(fine, axes, counts, free, half, above),
    );
    if let (Some(from), Some(to)) = (&fine.pressures, &mut coarse.pressures) {
        from.coarsen(axes, to);
        to.hold(&coarse.free);
    }
}

/// Rows of a coarse matrix from a node on.
fn rows(
    fine: &Level,
    axes: &[Axis; 3],
    counts: [usize; 3],
    free: &[u8],
    first: usize,
    matrix: Rows<'_>,
) {
    let offsets = offsets(counts);
    matrix.write(|place, blocks| {
        let node = first + place;
        row(fine, axes, indices(counts, node), blocks);
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
fn row(fine: &Level, axes: &[Axis; 3], at: [usize; 3], blocks: &mut Row) {
    let children = [0, 1, 2].map(|axis| &axes[axis].children[at[axis]]);
    let first = children.map(|list| list[0].0.saturating_sub(1));
    let mut sums = [[0.0; COMPONENTS * COMPONENTS]; REACH * REACH * REACH];
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
    blocks.fill([0.0; COMPONENTS * COMPONENTS]);
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

/// Makes the residual of a grid the right-hand side of the next coarser one.
pub(super) fn restrict(fine: &Level, coarse: &mut Level) {
    let axes = fine
        .transfer
        .as_ref()
        .expect("a coarser grid has a transfer");
    if let (Some(from), Some(to)) = (&fine.pressures, &mut coarse.pressures) {
        from.restrict(axes, to);
    }
    let (counts, residual) = (coarse.counts, fine.residual.nodes());
    for (node, rhs) in coarse.rhs.nodes_mut().iter_mut().enumerate() {
        let at = indices(counts, node);
        let children = [0, 1, 2].map(|axis| &axes[axis].children[at[axis]]);
        *rhs = [0.0; COMPONENTS];
        for &(z, weight_z) in children[2] {
            for &(y, weight_y) in children[1] {
                for &(x, weight_x) in children[0] {
                    let weight = weight_x * weight_y * weight_z;
                    let from = &residual[node_at(fine.counts, [x, y, z])];
                    for (sum, value) in rhs.iter_mut().zip(from) {
                        *sum += weight * value;
                    }
                }
            }
        }
    }
}

/// Adds the solution of a coarser grid.
pub(super) fn correct(fine: &mut Level, coarse: &Level) {
    let axes = fine
        .transfer
        .as_ref()
        .expect("a coarser grid has a transfer");
    if let (Some(to), Some(from)) = (&mut fine.pressures, &coarse.pressures) {
        to.add_coarse(axes, from);
    }
    let (counts, correction) = (fine.counts, coarse.x.nodes());
    for (node, x) in fine.x.nodes_mut().iter_mut().enumerate() {
        for (parent, weight) in parents(axes, indices(counts, node)) {
            let from = &correction[node_at(coarse.counts, parent)];
            for (x, value) in x.iter_mut().zip(from) {
                *x += weight * value;
            }
        }
    }
}
