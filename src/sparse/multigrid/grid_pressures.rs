//! Elements of a grid with their pressures. They count like their first nodes; there is none where a node is a last one along an axis.

use crate::sparse::multigrid::node_grid::{
    AtNode, Axis, Block, COMPONENTS, CORNERS, NEIGHBOURS, OWN, corners, indices, neighbour_of,
    node_at,
};
use crate::sparse::multigrid::pressures::{Elements, Field};
use std::ops::Range;

/// Rows of neighbours, three in each.
const ROWS: usize = NEIGHBOURS / 3;

/// The elements of a grid.
#[derive(Debug)]
pub(super) struct GridElements {
    counts: [usize; 3],
    corners: [usize; CORNERS],
    /// Element of the next coarser grid that each is a part of; none of the coarsest grid.
    parents: Vec<u32>,
    /// S, by element and neighbour.
    schur: Vec<[f32; NEIGHBOURS]>,
}

impl GridElements {
    /// Of a grid, with the transfer to a coarser one.
    pub(super) fn new(counts: [usize; 3], transfer: Option<&[Axis; 3]>) -> Self {
        let nodes = 0..counts.iter().product();
        let parents = transfer.map(|axes| {
            let coarse = axes.each_ref().map(|axis| axis.kept.len());
            let parent = |element: usize| {
                let at = indices(counts, element);
                let below = |axis: usize| axes[axis].kept.partition_point(|&k| k <= at[axis]) - 1;
                node_at(coarse, [0, 1, 2].map(below)) as u32
            };
            nodes.clone().map(parent).collect()
        });
        Self {
            counts,
            corners: corners(counts),
            parents: parents.unwrap_or_default(),
            schur: vec![[0.0; NEIGHBOURS]; nodes.len()],
        }
    }
}

impl Elements for GridElements {
    fn field(&self) -> Field {
        let [n_x, n_y, _] = self.counts;
        Field::new(self.schur.len(), n_x * n_y + n_x + 1)
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

    fn of_node(&self, node: usize) -> impl Iterator<Item = usize> {
        let steps = self.corners.iter();
        steps.filter_map(move |step| node.checked_sub(*step))
    }

    fn parent(&self, element: usize) -> usize {
        self.parents[element] as usize
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
    fn product(&self, element: usize, x: &Field) -> f32 {
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
