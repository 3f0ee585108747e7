//! The matrix of one level in single precision by triangles: blocks of each node with the neighbours before it, with itself, and with those
//! behind it; and the pattern of its rows.
//!
//! A sweep reads a triangle from one end to the other. In one list of all rows it would leave out half of each, which takes four times as
//! long.

use crate::math::join;
use crate::sparse::multigrid::node_grid::{
    AtNode, Block, COMPONENTS, GridNode, add, indices, near, node_at,
};
use std::cmp::Ordering;
use std::ops::Range;
use std::slice::IterMut;
use std::sync::Arc;

/// A mesh whose nodes are on no grid.
#[derive(Clone, Debug, PartialEq)]
pub struct NodeMesh {
    /// Places of the nodes in mm.
    pub places: Vec<[f64; 3]>,
    /// Nodes of each element; of a hexahedron around its lower face, then around its upper one.
    pub elements: Vec<Vec<u32>>,
    /// Unknowns of each node by component; `None` where the value is given.
    pub unknowns: Vec<[Option<u32>; COMPONENTS]>,
    /// Length of the shortest edge in mm.
    pub shortest_edge: f64,
    /// True if the elements are hexahedra with pressures, as they resist changes of their volumes by far more than anything else.
    pub has_pressures: bool,
}

/// Distance of two places.
pub(super) fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    let squares = a.iter().zip(b).map(|(a, b)| (a - b) * (a - b));
    squares.sum::<f64>().sqrt()
}

/// Places of the blocks of a matrix by node.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct BlockPlaces {
    /// First node and first block of each box and mesh, and its pattern.
    pub(super) parts: Vec<(usize, usize, Arc<BlockRows>)>,
}

impl BlockPlaces {
    /// Number of the block of the rows of a node and the columns of another one; `None` where they are no neighbours.
    #[inline(always)]
    pub fn block(&self, row: GridNode, column: GridNode) -> Option<usize> {
        match [row, column].map(GridNode::is_on_box) {
            [true, true] => row.neighbour_block(column),
            [false, false] => {
                let (first, block, rows) = self.part(row.number());
                let column = column.number().checked_sub(*first)?;
                Some(block + rows.find(row.number() - first, column)?)
            }
            _ => None,
        }
    }

    /// The block on the diagonal of a node.
    pub(super) fn diagonal(&self, node: usize) -> usize {
        let (first, block, rows) = self.part(node);
        block + rows.diagonal(node - first)
    }

    fn part(&self, node: usize) -> &(usize, usize, Arc<BlockRows>) {
        let part = self.parts.iter().rfind(|part| part.0 <= node);
        part.expect("nodes belong to a part")
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
    pub(super) fn of_elements(nodes: usize, elements: &[Vec<u32>]) -> Self {
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

    /// The pattern of the matrix that couples the nodes of each element of a box, with planes of nodes along each axis.
    pub(super) fn of_box(counts: [usize; 3]) -> Self {
        let (mut starts, mut columns) = (vec![0], Vec::new());
        for node in 0..counts.iter().product() {
            let at = indices(counts, node);
            let [along_x, along_y, along_z] = [0, 1, 2].map(|axis| near(counts[axis], at[axis]));
            for z in along_z {
                for y in along_y.clone() {
                    let of_line = along_x.clone();
                    columns.extend(of_line.map(|x| node_at(counts, [x, y, z]) as u32));
                }
            }
            starts.push(columns.len());
        }
        Self { starts, columns }
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

    /// Writes products of the rows, both halves at once: `add` adds that of a block and what stands at a node.
    #[inline]
    pub(super) fn multiply<B: Sync, X: Sync, Y: Default + Send>(
        &self,
        blocks: &[B],
        x: &[X],
        product: &mut [Y],
        add: impl Fn(&mut Y, &B, &X) + Sync,
    ) {
        let half = product.len() / 2;
        let (lower, upper) = product.split_at_mut(half);
        let rows = |first: usize, product: &mut [Y]| {
            for (row, product) in (first..).zip(product) {
                let mut sum = Y::default();
                let blocks = blocks[self.range(row)].iter();
                for (block, column) in blocks.zip(self.columns(row)) {
                    add(&mut sum, block, &x[*column as usize]);
                }
                *product = sum;
            }
        };
        join(|| rows(0, lower), || rows(half, upper));
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

/// Blocks of a row with their columns.
#[derive(Clone, Copy, Debug)]
pub(super) struct Couplings<'m> {
    blocks: &'m [Block],
    pub(super) columns: &'m [u32],
}

impl Couplings<'_> {
    /// The first ones.
    #[inline(always)]
    pub(super) fn before(self, place: usize) -> Self {
        Self {
            blocks: &self.blocks[..place],
            columns: &self.columns[..place],
        }
    }

    /// The others.
    #[inline(always)]
    pub(super) fn from(self, place: usize) -> Self {
        Self {
            blocks: &self.blocks[place..],
            columns: &self.columns[place..],
        }
    }

    /// Adds their products with what stands in a list from the node `first` on.
    #[inline(always)]
    pub(super) fn add_to(self, sum: &mut AtNode, first: usize, x: &[AtNode]) {
        for (block, column) in self.blocks.iter().zip(self.columns) {
            add(sum, block, &x[*column as usize - first]);
        }
    }

    /// The same from the last one to the first.
    #[inline(always)]
    pub(super) fn add_backward_to(self, sum: &mut AtNode, first: usize, x: &[AtNode]) {
        for (block, column) in self.blocks.iter().zip(self.columns).rev() {
            add(sum, block, &x[*column as usize - first]);
        }
    }
}

/// A matrix with blocks by row.
#[derive(Debug)]
pub(super) struct BlockMatrix {
    pub(super) rows: Arc<BlockRows>,
    /// First block of each row in the lower triangle, and the number of all.
    lower_starts: Vec<usize>,
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

impl<'m> Rows<'m> {
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
}

impl BlockMatrix {
    /// Zero, with this pattern.
    pub(super) fn new(rows: Arc<BlockRows>) -> Self {
        let (nodes, lower_starts) = (rows.count(), rows.lower_starts());
        let lower = lower_starts[nodes];
        let zero = |count: usize| vec![Block::default(); count];
        Self {
            lower: zero(lower),
            diagonal: zero(nodes),
            upper: zero(rows.blocks() - nodes - lower),
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
        let mut rows = Rows {
            lower: self.lower.iter_mut(),
            diagonal: self.diagonal.iter_mut(),
            upper: self.upper.iter_mut(),
        };
        for (row, column) in self.rows.entries() {
            change(row, column, rows.next(row, column));
        }
    }

    /// Leaves rows and columns of given values out; `free` has a bit for each component of a node without one. Multiplies the diagonal.
    pub(super) fn hold(&mut self, free: &[u8], of_diagonal: f32) {
        self.each_mut(|row, column, block| {
            for (entry, value) in block.iter_mut().enumerate() {
                let at = [entry % COMPONENTS, entry / COMPONENTS];
                if free[row] & 1 << at[0] == 0 || free[column] & 1 << at[1] == 0 {
                    *value = 0.0;
                } else if row == column && at[0] == at[1] {
                    *value *= of_diagonal;
                }
            }
        });
    }

    /// Both halves of the rows.
    pub(super) fn in_two(&mut self) -> [Rows<'_>; 2] {
        let half = self.rows.count() / 2;
        let [lower, upper] = self.sides(half).map(|blocks| blocks.start);
        let (a, b) = self.lower.split_at_mut(lower);
        let (c, d) = self.diagonal.split_at_mut(half);
        let (e, f) = self.upper.split_at_mut(upper);
        [[a, c, e], [b, d, f]].map(|lists| {
            let [lower, diagonal, upper] = lists.map(<[Block]>::iter_mut);
            Rows {
                lower,
                diagonal,
                upper,
            }
        })
    }

    /// Places of a row in the lower and in the upper triangle.
    #[inline(always)]
    fn sides(&self, row: usize) -> [Range<usize>; 2] {
        let (start, end) = (self.rows.range(row).start, self.rows.range(row).end);
        let [lower, behind] = [self.lower_starts[row], self.lower_starts[row + 1]];
        [lower..behind, start - row - lower..end - row - 1 - behind]
    }

    /// The blocks of a row, by column.
    #[inline(always)]
    pub(super) fn row(&self, row: usize) -> impl Iterator<Item = &Block> {
        let [lower, upper] = self.sides(row);
        let own = std::iter::once(&self.diagonal[row]);
        let lower = self.lower[lower].iter();
        lower.chain(own).chain(&self.upper[upper])
    }

    /// All blocks row by row.
    pub(super) fn blocks(&self) -> impl Iterator<Item = &Block> {
        (0..self.rows.count()).flat_map(|row| self.row(row))
    }

    /// The block on the diagonal.
    #[inline(always)]
    pub(super) fn diagonal(&self, row: usize) -> &Block {
        &self.diagonal[row]
    }

    /// Blocks of a row before the diagonal, and behind it.
    #[inline(always)]
    pub(super) fn couplings(&self, row: usize) -> [Couplings<'_>; 2] {
        let [lower, upper] = self.sides(row);
        let (before, behind) = self.rows.columns(row).split_at(lower.len());
        let lists = [
            (&self.lower[lower], before),
            (&self.upper[upper], &behind[1..]),
        ];
        lists.map(|list| Couplings {
            blocks: list.0,
            columns: list.1,
        })
    }

    /// Product of a row.
    pub(super) fn product(&self, row: usize, x: &[AtNode]) -> AtNode {
        let mut sum = AtNode::default();
        let [before, behind] = self.couplings(row);
        before.add_to(&mut sum, 0, x);
        add(&mut sum, &self.diagonal[row], &x[row]);
        behind.add_to(&mut sum, 0, x);
        sum
    }
}

/// A row, and the place in it of each of its columns.
#[derive(Debug, Default)]
pub(super) struct Marks {
    places: Vec<u32>,
    row: Vec<Block>,
}

impl Marks {
    /// Work space of either half of rows with so many columns.
    pub(super) fn of_halves(columns: usize) -> [Self; 2] {
        [(); 2].map(|()| Self {
            places: vec![0; columns],
            row: Vec::new(),
        })
    }
}

/// Writes rows one after the other to either half of the blocks of a pattern.
pub(super) fn in_two<'v>(
    values: &'v mut [Block],
    pattern: &BlockRows,
) -> [impl FnMut(usize, &[Block]) + Send + use<'v>; 2] {
    let half = pattern.count() / 2;
    let (lower, upper) = values.split_at_mut(pattern.range(half).start);
    [lower, upper].map(|half| {
        let mut rest = half;
        move |_: usize, blocks: &[Block]| {
            let (own, behind) = std::mem::take(&mut rest).split_at_mut(blocks.len());
            own.copy_from_slice(blocks);
            rest = behind;
        }
    })
}

/// Finds each row of a pattern by `find`, which is handed its blocks as zeros and the place of each of its columns, and hands it over; both
/// halves of the rows at once.
pub(super) fn each_row(
    pattern: &BlockRows,
    halves: [impl FnMut(usize, &[Block]) + Send; 2],
    marks: &mut [Marks; 2],
    find: impl Fn(usize, &mut [Block], &[u32]) + Sync,
) {
    let half = pattern.count() / 2;
    let of_rows =
        |rows: Range<usize>, hand_over: &mut dyn FnMut(usize, &[Block]), marks: &mut Marks| {
            let Marks { places, row: own } = marks;
            for row in rows {
                let columns = pattern.columns(row);
                for (place, column) in columns.iter().enumerate() {
                    places[*column as usize] = place as u32;
                }
                own.clear();
                own.resize(columns.len(), Block::default());
                find(row, own, places);
                hand_over(row, own);
            }
        };
    let ([mut a, mut b], [of_a, of_b]) = (halves, marks);
    join(
        || of_rows(0..half, &mut a, of_a),
        || of_rows(half..pattern.count(), &mut b, of_b),
    );
}

impl BlockMatrix {
    /// Writes all rows as `find` finds them.
    pub(super) fn write_rows(
        &mut self,
        marks: &mut [Marks; 2],
        find: impl Fn(usize, &mut [Block], &[u32]) + Sync,
    ) {
        let pattern = self.rows.clone();
        let halves = self.in_two().map(|mut rows| {
            let pattern = &pattern;
            move |row: usize, blocks: &[Block]| {
                for (block, column) in blocks.iter().zip(pattern.columns(row)) {
                    *rows.next(row, *column as usize) = *block;
                }
            }
        });
        each_row(&pattern, halves, marks, find);
    }
}
