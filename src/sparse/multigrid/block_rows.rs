//! The pattern of a sparse matrix of blocks, row by row.

use std::ops::Range;

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
