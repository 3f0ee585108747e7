//! Elements of a grid with their pressures. They count like their first nodes; there is none where a node is a last one along an axis.

use crate::sparse::multigrid::node_grid::{
    Axis, CORNERS, NEIGHBOURS, corners, indices, neighbour_of, node_at,
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
    /// Number of nodes; S is by element and neighbour.
    count: usize,
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
            count: nodes.len(),
        }
    }
}

impl Elements for GridElements {
    fn field(&self) -> Field {
        let [n_x, n_y, _] = self.counts;
        Field::new(self.count, n_x * n_y + n_x + 1)
    }

    fn slopes(&self) -> usize {
        CORNERS * self.count
    }

    #[inline(always)]
    fn range(&self, element: usize) -> Range<usize> {
        CORNERS * element..CORNERS * element + CORNERS
    }

    #[inline(always)]
    fn nodes(&self, element: usize) -> impl Iterator<Item = usize> {
        self.corners.iter().map(move |corner| element + corner)
    }

    fn of_node(&self, node: usize) -> impl Iterator<Item = [usize; 2]> {
        let steps = self.corners.iter().enumerate();
        steps.filter_map(move |(corner, step)| {
            let element = node.checked_sub(*step)?;
            Some([element, CORNERS * element + corner])
        })
    }

    fn parent(&self, element: usize) -> usize {
        self.parents[element] as usize
    }

    fn entries(&self) -> usize {
        NEIGHBOURS * self.count
    }

    fn entry(&self, row: [usize; 2], column: [usize; 2]) -> usize {
        let [of_row, of_column] = [row[1], column[1]].map(|place| place % CORNERS);
        NEIGHBOURS * row[0] + neighbour_of(of_column, of_row)
    }

    #[inline(always)]
    fn product(&self, element: usize, schur: &[f32], x: &Field) -> f32 {
        let [n_x, n_y, _] = self.counts;
        // The margin keeps all neighbours in the list.
        let first = x.margin + element - n_x * n_y - n_x - 1;
        let schur = &schur[NEIGHBOURS * element..][..NEIGHBOURS];
        let mut sums = [0.0; ROWS];
        for (row, sum) in sums.iter_mut().enumerate() {
            let entries = &schur[3 * row..3 * row + 3];
            let there = &x.values[first + n_x * (row % 3 + n_y * (row / 3))..][..3];
            *sum = entries[0] * there[0] + entries[1] * there[1] + entries[2] * there[2];
        }
        sums.iter().sum()
    }
}
