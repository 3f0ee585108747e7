//! The matrix of one level in single precision by triangles: blocks of each node with the neighbours before it, with itself, and with those
//! behind it.
//!
//! A sweep reads a triangle from one end to the other. In one list of all rows it would leave out half of each, which takes four times as
//! long.
//!
//! The pattern of a sparse matrix of blocks, row by row.
//!
//! The matrix of one level of a mesh in single precision, with the pattern of its rows.

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

/// Columns of each row, ascending.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct BlockRows {
    /// First block of each row, and the number of all.
    starts: Vec<usize>,
    columns: Vec<u32>,
}

impl BlockRows {
    /// Of the columns of each row, in any order, some perhaps more than once.
    pub(super) fn new(rows: impl Iterator<Item = Vec<u32>>) -> Self {
        let mut found = Self {
            starts: vec![0],
            columns: Vec::new(),
        };
        for mut columns in rows {
            columns.sort_unstable();
            columns.dedup();
            found.columns.extend(columns);
            found.starts.push(found.columns.len());
        }
        found
    }

    /// The pattern of the matrix that couples the nodes of each element with each other.
    pub(super) fn of_elements(nodes: usize, elements: &[[u32; 8]]) -> Self {
        let mut rows = vec![Vec::new(); nodes];
        for element in elements {
            for &node in element {
                rows[node as usize].extend_from_slice(element);
            }
        }
        for (node, row) in rows.iter_mut().enumerate() {
            row.push(node as u32);
        }
        Self::new(rows.into_iter())
    }

    /// Number of rows.
    pub(super) fn count(&self) -> usize {
        self.starts.len().saturating_sub(1)
    }

    /// Number of blocks.
    pub(super) fn blocks(&self) -> usize {
        self.columns.len()
    }

    /// Blocks of a row.
    #[inline(always)]
    pub(super) fn range(&self, row: usize) -> Range<usize> {
        self.starts[row]..self.starts[row + 1]
    }

    /// Row and column of each block, in order.
    pub(super) fn entries(&self) -> impl Iterator<Item = (usize, usize)> {
        let of_row = |row: usize| self.columns(row).iter().map(move |&c| (row, c as usize));
        (0..self.count()).flat_map(of_row)
    }

    /// Columns of a row.
    #[inline(always)]
    pub(super) fn columns(&self, row: usize) -> &[u32] {
        &self.columns[self.range(row)]
    }

    /// Column of a block.
    #[inline(always)]
    pub(super) fn column(&self, block: usize) -> usize {
        self.columns[block] as usize
    }

    /// The block of a row and a column; `None` where there is none.
    #[inline]
    pub(super) fn find(&self, row: usize, column: usize) -> Option<usize> {
        let place = self.columns(row).binary_search(&(column as u32)).ok()?;
        Some(self.starts[row] + place)
    }

    /// The block on the diagonal, which every row has.
    #[inline]
    pub(super) fn diagonal(&self, row: usize) -> usize {
        self.find(row, row).expect("a row has its diagonal")
    }

    /// Number of blocks before the diagonal in all rows before each one, and in all.
    pub(super) fn lower_starts(&self) -> Vec<usize> {
        let mut starts = vec![0];
        for row in 0..self.count() {
            let before = self.columns(row).partition_point(|&c| (c as usize) < row);
            starts.push(starts[row] + before);
        }
        starts
    }

    /// The pattern of the product of this matrix with another one.
    pub(super) fn times(&self, other: &Self) -> Self {
        Self::new((0..self.count()).map(|row| {
            let mut columns = Vec::new();
            for &column in self.columns(row) {
                columns.extend_from_slice(other.columns(column as usize));
            }
            columns
        }))
    }

    /// Rows, and blocks, of each column of a number of columns.
    pub(super) fn by_column(&self, count: usize) -> Vec<Vec<[u32; 2]>> {
        let mut found = vec![Vec::new(); count];
        for row in 0..self.count() {
            for block in self.range(row) {
                found[self.column(block)].push([row as u32, block as u32]);
            }
        }
        found
    }
}

/// A block with its column.
type Coupling<'m> = (&'m Block, &'m u32);

/// A matrix with blocks by row.
#[derive(Debug)]
pub(super) struct MeshMatrix {
    pub(super) rows: Arc<BlockRows>,
    /// First block of each row in the lower triangle, and the number of all.
    lower_starts: Vec<usize>,
    blocks: Triangles,
}

impl MeshMatrix {
    /// Zero, with this pattern.
    pub(super) fn new(rows: Arc<BlockRows>) -> Self {
        let (nodes, lower_starts) = (rows.count(), rows.lower_starts());
        let lower = lower_starts[nodes];
        let counts = [lower, rows.blocks() - nodes - lower];
        Self {
            blocks: Triangles::new(nodes, counts),
            lower_starts,
            rows,
        }
    }

    /// Writes the blocks, which count row by row.
    pub(super) fn write(&mut self, of: impl Fn(usize) -> Block) {
        let mut number = 0;
        self.each_mut(|_, _, block| {
            *block = of(number);
            number += 1;
        });
    }

    /// Calls `change` with row, column and block of each.
    pub(super) fn each_mut(&mut self, mut change: impl FnMut(usize, usize, &mut Block)) {
        let mut rows = self.blocks.rows_mut();
        for (row, column) in self.rows.entries() {
            change(row, column, rows.next(row, column));
        }
    }

    /// Both halves of the rows.
    pub(super) fn in_two(&mut self) -> [Rows<'_>; 2] {
        let half = self.rows.count() / 2;
        let before = self.halves(half).map(|blocks| blocks.start);
        self.blocks.rows_mut().split_at(half, before)
    }

    /// Places of a row in the lower and in the upper triangle.
    #[inline(always)]
    fn halves(&self, row: usize) -> [Range<usize>; 2] {
        let (start, end) = (self.rows.range(row).start, self.rows.range(row).end);
        let [lower, behind] = [self.lower_starts[row], self.lower_starts[row + 1]];
        [lower..behind, start - row - lower..end - row - 1 - behind]
    }

    /// The blocks of a row, by column.
    #[inline(always)]
    pub(super) fn row(&self, row: usize) -> impl Iterator<Item = &Block> {
        self.blocks.row(row, self.halves(row))
    }

    /// All blocks row by row.
    pub(super) fn blocks(&self) -> impl Iterator<Item = &Block> {
        (0..self.rows.count()).flat_map(|row| self.row(row))
    }

    /// Blocks of a row before the diagonal.
    #[inline(always)]
    pub(super) fn lower(&self, row: usize) -> impl DoubleEndedIterator<Item = Coupling<'_>> {
        let [lower, _] = self.halves(row);
        let columns = &self.rows.columns(row)[..lower.len()];
        self.blocks.lower(lower).iter().zip(columns)
    }

    /// The block on the diagonal.
    #[inline(always)]
    pub(super) fn diagonal(&self, row: usize) -> &Block {
        self.blocks.diagonal(row)
    }

    /// Blocks of a row behind the diagonal.
    #[inline(always)]
    pub(super) fn upper(&self, row: usize) -> impl DoubleEndedIterator<Item = Coupling<'_>> {
        let [lower, upper] = self.halves(row);
        let columns = &self.rows.columns(row)[lower.len() + 1..];
        self.blocks.upper(upper).iter().zip(columns)
    }
}
