//! Elements of a grid with their pressures. They count like their first nodes; there is none where a node is a last one along an axis.

use crate::sparse::multigrid::node_grid::{
    AtNode, Axis, Block, COMPONENTS, CORNERS, Field, NEIGHBOURS, OWN, corners, indices,
    neighbour_of, node_at,
};
use crate::sparse::multigrid::pressures::{Elements, Pressures};
use std::ops::Range;

/// Rows of neighbours, three in each.
const ROWS: usize = NEIGHBOURS / 3;

/// The elements of a grid.
#[derive(Debug)]
pub(super) struct GridElements {
    counts: [usize; 3],
    corners: [usize; CORNERS],
    /// Number of planes of the next coarser grid, and the plane of it at or below each plane along an axis.
    coarse: [usize; 3],
    below: [Vec<usize>; 3],
    /// S, by element and neighbour.
    schur: Vec<[f32; NEIGHBOURS]>,
}

impl GridElements {
    /// Of a grid, with the transfer to a coarser one.
    pub(super) fn new(counts: [usize; 3], transfer: Option<&[Axis; 3]>) -> Self {
        let axes = transfer.map(<[Axis; 3]>::each_ref);
        let below = |axis: &Axis| {
            let planes = 0..axis.parents.len();
            let below = planes.map(|plane| axis.kept.partition_point(|&kept| kept <= plane) - 1);
            below.collect()
        };
        Self {
            counts,
            corners: corners(counts),
            coarse: axes.map_or([0; 3], |axes| axes.map(|axis| axis.kept.len())),
            below: axes.map_or_else(Default::default, |axes| axes.map(below)),
            schur: vec![[0.0; NEIGHBOURS]; counts.iter().product()],
        }
    }

    /// Axis indices of the coarser element that an element is part of.
    fn above(&self, element: usize) -> [usize; 3] {
        let at = indices(self.counts, element);
        std::array::from_fn(|axis| self.below[axis][at[axis]])
    }
}

impl Elements for GridElements {
    fn field(&self) -> Field<f32> {
        Field::new(self.counts)
    }

    fn slopes(&self) -> usize {
        CORNERS * self.schur.len()
    }

    #[inline(always)]
    fn range(&self, element: usize) -> Range<usize> {
        CORNERS * element..CORNERS * element + CORNERS
    }

    #[inline(always)]
    fn nodes(&self, element: usize) -> impl Iterator<Item = usize> {
        self.corners.iter().map(move |corner| element + corner)
    }

    fn parent(&self, element: usize) -> usize {
        node_at(self.coarse, self.above(element))
    }

    fn couple(&mut self, slopes: &[AtNode], compliance: &[f32], blocks: &[Block]) {
        for (element, row) in self.schur.iter_mut().enumerate() {
            row.fill(0.0);
            row[OWN] = compliance[element];
            if compliance[element] == 0.0 {
                continue;
            }
            for corner in 0..CORNERS {
                let node = element + self.corners[corner];
                let own = &slopes[CORNERS * element + corner];
                let block = &blocks[node];
                let moved: AtNode = std::array::from_fn(|row| {
                    let entry = |col: usize| block[COMPONENTS * col + row];
                    let turned = |col: usize| block[COMPONENTS * row + col];
                    let each =
                        (0..COMPONENTS).map(|col| 0.5 * (entry(col) + turned(col)) * own[col]);
                    each.sum()
                });
                for of_other in 0..CORNERS {
                    let Some(other) = node.checked_sub(self.corners[of_other]) else {
                        continue;
                    };
                    // The node is one corner of both.
                    let there = &slopes[CORNERS * other + of_other];
                    let product: f32 = moved.iter().zip(there).map(|(a, b)| a * b).sum();
                    row[neighbour_of(of_other, corner)] += product;
                }
            }
        }
    }

    fn diagonal(&self, element: usize) -> f32 {
        self.schur[element][OWN]
    }

    #[inline(always)]
    fn product(&self, element: usize, x: &Field<f32>) -> f32 {
        let [n_x, n_y, _] = self.counts;
        // The margin keeps all neighbours in the list.
        let first = x.margin + element - n_x * n_y - n_x - 1;
        let mut sums = [0.0; ROWS];
        for (row, sum) in sums.iter_mut().enumerate() {
            let entries = &self.schur[element][3 * row..3 * row + 3];
            let there = &x.values[first + n_x * (row % 3 + n_y * (row / 3))..][..3];
            *sum = entries[0] * there[0] + entries[1] * there[1] + entries[2] * there[2];
        }
        sums.iter().sum()
    }

    fn bytes(&self) -> usize {
        let of_slopes = CORNERS * size_of::<AtNode>();
        self.schur.len() * (of_slopes + size_of::<[f32; NEIGHBOURS + 9]>())
    }
}

impl Pressures<GridElements> {
    /// Writes the slopes and compliances of a coarser grid, without the slopes by values that are given there: an element takes in those
    /// that it consists of. `free` has a bit for each component of a coarse node that moves.
    pub(super) fn coarsen(&self, axes: &[Axis; 3], free: &[u8], coarse: &mut Self) {
        coarse.slopes.fill(AtNode::default());
        coarse.compliance.fill(0.0);
        for (element, slopes) in self.slopes.chunks_exact(CORNERS).enumerate() {
            if self.compliance[element] == 0.0 {
                continue;
            }
            let parent = self.elements.above(element);
            let to = self.elements.parent(element);
            coarse.compliance[to] += self.compliance[element];
            let at = indices(self.elements.counts, element);
            for (corner, slopes) in slopes.iter().enumerate() {
                let weights = [0, 1, 2].map(|axis| {
                    let plane = at[axis] + (corner >> axis & 1);
                    let mut weights = [0.0; 2];
                    for &(coarse, weight) in &axes[axis].parents[plane] {
                        if weight > 0.0 {
                            weights[coarse - parent[axis]] += weight;
                        }
                    }
                    weights
                });
                for of_coarse in 0..CORNERS {
                    let weight: f32 = (0..3)
                        .map(|axis| weights[axis][of_coarse >> axis & 1])
                        .product();
                    let to = &mut coarse.slopes[CORNERS * to + of_coarse];
                    for (sum, slope) in to.iter_mut().zip(slopes) {
                        *sum += weight * slope;
                    }
                }
            }
        }
        for (element, slopes) in coarse.slopes.chunks_exact_mut(CORNERS).enumerate() {
            for (slopes, node) in slopes.iter_mut().zip(coarse.elements.nodes(element)) {
                let free = free.get(node).copied().unwrap_or_default();
                for (component, slope) in slopes.iter_mut().enumerate() {
                    if free & (1 << component) == 0 {
                        *slope = 0.0;
                    }
                }
            }
        }
    }
}
