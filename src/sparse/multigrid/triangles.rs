//! The matrix of one level in single precision by triangles: blocks of each node with the neighbours before it, with itself, and with those
//! behind it.
//!
//! A sweep reads a triangle from one end to the other. In one list of all rows it would leave out half of each, which takes four times as
//! long.

use crate::sparse::multigrid::block_rows::BlockRows;
use crate::sparse::multigrid::node_grid::{Block, COMPONENTS, GridNode, NEIGHBOURS, OWN};
use std::cmp::Ordering;
use std::ops::Range;
use std::slice::IterMut;
use std::sync::Arc;

/// A row of the matrix of a grid, by neighbour.
pub(super) type Row = [Block; NEIGHBOURS];

/// Blocks by row; on a grid those of neighbours beyond it are zero.
#[derive(Debug)]
pub(super) struct Triangles {
    lower: Vec<Block>,
    diagonal: Vec<Block>,
    upper: Vec<Block>,
}

/// Blocks of some rows in a sequence that are to be written.
pub(super) struct Rows<'m> {
    lower: IterMut<'m, Block>,
    diagonal: IterMut<'m, Block>,
    upper: IterMut<'m, Block>,
}

impl Triangles {
    /// Zero, with so many blocks on the diagonal and in either triangle.
    pub(super) fn new(nodes: usize, [lower, upper]: [usize; 2]) -> Self {
        Self {
            lower: vec![Block::default(); lower],
            diagonal: vec![Block::default(); nodes],
            upper: vec![Block::default(); upper],
        }
    }

    /// Zero for the nodes of a grid.
    pub(super) fn of_grid(nodes: usize) -> Self {
        Self::new(nodes, [OWN * nodes; 2])
    }

    /// Number of blocks.
    pub(super) fn blocks(&self) -> usize {
        self.lower.len() + self.diagonal.len() + self.upper.len()
    }

    /// Blocks of the lower triangle.
    #[inline(always)]
    pub(super) fn lower(&self, blocks: Range<usize>) -> &[Block] {
        &self.lower[blocks]
    }

    /// The block of a node with itself.
    #[inline(always)]
    pub(super) fn diagonal(&self, node: usize) -> &Block {
        &self.diagonal[node]
    }

    /// Blocks of the upper triangle.
    #[inline(always)]
    pub(super) fn upper(&self, blocks: Range<usize>) -> &[Block] {
        &self.upper[blocks]
    }

    /// A row with these blocks of the lower and of the upper triangle, by column.
    #[inline(always)]
    pub(super) fn row(
        &self,
        node: usize,
        [lower, upper]: [Range<usize>; 2],
    ) -> impl Iterator<Item = &Block> {
        let own = std::iter::once(&self.diagonal[node]);
        self.lower[lower]
            .iter()
            .chain(own)
            .chain(&self.upper[upper])
    }

    /// A row of a grid, by neighbour.
    #[inline(always)]
    pub(super) fn grid_row(&self, node: usize) -> impl Iterator<Item = &Block> {
        let half = OWN * node..OWN * (node + 1);
        self.row(node, [half.clone(), half])
    }

    /// All rows.
    pub(super) fn rows_mut(&mut self) -> Rows<'_> {
        Rows {
            lower: self.lower.iter_mut(),
            diagonal: self.diagonal.iter_mut(),
            upper: self.upper.iter_mut(),
        }
    }
}

impl<'m> Rows<'m> {
    /// The rows before a node, with so many blocks in either triangle, and the others.
    pub(super) fn split_at(self, node: usize, [lower, upper]: [usize; 2]) -> [Self; 2] {
        let split = |blocks: IterMut<'m, Block>, at: usize| {
            let (before, behind) = blocks.into_slice().split_at_mut(at);
            (before.iter_mut(), behind.iter_mut())
        };
        let (lower, lower_behind) = split(self.lower, lower);
        let (diagonal, diagonal_behind) = split(self.diagonal, node);
        let (upper, upper_behind) = split(self.upper, upper);
        [
            Self {
                lower,
                diagonal,
                upper,
            },
            Self {
                lower: lower_behind,
                diagonal: diagonal_behind,
                upper: upper_behind,
            },
        ]
    }

    /// The next block, row by row, of these row and column.
    ///
    /// # Panics
    /// There are no more of its triangle.
    pub(super) fn next(&mut self, row: usize, column: usize) -> &'m mut Block {
        let next = match column.cmp(&row) {
            Ordering::Less => self.lower.next(),
            Ordering::Equal => self.diagonal.next(),
            Ordering::Greater => self.upper.next(),
        };
        next.expect("blocks are those of the pattern")
    }

    /// Writes rows of a grid, whose numbers among these are handed over.
    pub(super) fn write(self, mut row: impl FnMut(usize, &mut Row)) {
        let mut blocks = [Block::default(); NEIGHBOURS];
        let [lower, upper] =
            [self.lower, self.upper].map(|triangle| triangle.into_slice().chunks_exact_mut(OWN));
        let lists = lower.zip(self.diagonal).zip(upper);
        for (number, ((lower, diagonal), upper)) in lists.enumerate() {
            row(number, &mut blocks);
            lower.copy_from_slice(&blocks[..OWN]);
            *diagonal = blocks[OWN];
            upper.copy_from_slice(&blocks[OWN + 1..]);
        }
    }
}

/// A mesh of hexahedra whose nodes are on no grid.
#[derive(Clone, Debug, PartialEq)]
pub struct NodeMesh {
    /// Places of the nodes in mm.
    pub places: Vec<[f64; 3]>,
    /// Nodes of each element: around its lower face, then around its upper one.
    pub elements: Vec<[u32; 8]>,
    /// Unknowns of each node by component; `None` where the value is given.
    pub unknowns: Vec<[Option<u32>; COMPONENTS]>,
    /// Length of the shortest edge in mm.
    pub shortest_edge: f64,
    /// True if elements have pressures, as they resist changes of their volumes by far more than anything else.
    pub has_pressures: bool,
}

/// Distance of two places.
pub(super) fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    let squares = a.iter().zip(b).map(|(a, b)| (a - b) * (a - b));
    squares.sum::<f64>().sqrt()
}

/// Places of the blocks of a matrix by node: those of boxes come first.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct BlockPlaces {
    /// Number of nodes of boxes.
    pub(super) of_boxes: usize,
    /// First node and first block of each mesh, and its pattern.
    pub(super) meshes: Vec<(usize, usize, Arc<BlockRows>)>,
}

impl BlockPlaces {
    /// Number of the block of the rows of a node and the columns of another one; `None` where they are no neighbours.
    #[inline(always)]
    pub fn block(&self, row: GridNode, column: GridNode) -> Option<usize> {
        let [row_number, column_number] = [row.number(), column.number()];
        if row_number < self.of_boxes {
            return match column_number < self.of_boxes {
                true => row.neighbour_block(column),
                false => None,
            };
        }
        let part = self.meshes.iter().rfind(|mesh| mesh.0 <= row_number)?;
        let (first, block, rows) = (part.0, part.1, &part.2);
        let column = column_number.checked_sub(first)?;
        Some(block + rows.find(row_number - first, column)?)
    }

    /// The block on the diagonal of a node.
    pub(super) fn diagonal(&self, node: usize) -> usize {
        match self.meshes.iter().rfind(|mesh| mesh.0 <= node) {
            Some((first, block, rows)) => block + rows.diagonal(node - first),
            None => NEIGHBOURS * node + OWN,
        }
    }
}
