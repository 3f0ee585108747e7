//! Rows of blocks that are found one after the other, in both halves of a matrix at once.

use crate::math::join;
use crate::sparse::multigrid::node_grid::Block;
use crate::sparse::multigrid::triangles::{BlockMatrix, BlockRows};
use std::ops::Range;

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
