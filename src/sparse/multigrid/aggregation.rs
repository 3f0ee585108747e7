//! Transfer by smoothed aggregation: P = (1 − ω D⁻¹ A) R, with the rigid motions R of aggregates, and the coarse matrix Pᵀ A P.
//!
//! In the factor of R weakly coupled neighbours move as the node itself does, so that P reaches no farther across thin layers.

use crate::math::join;
use crate::sparse::multigrid::aggregates::{Aggregates, Rigid};
use crate::sparse::multigrid::block_rows::BlockRows;
use crate::sparse::multigrid::field::{Block, add_product, add_transposed_product};
use std::ops::Range;

/// Transfer to a coarser level.
#[derive(Debug)]
pub(super) struct Aggregation {
    is_strong: Vec<bool>,
    rigid: Vec<[Rigid; 2]>,
    /// P.
    pub(super) pattern: BlockRows,
    pub(super) values: Vec<Block>,
    /// A P.
    products: BlockRows,
    of_products: Vec<Block>,
    /// Rows and blocks of P by column.
    pub(super) children: Vec<Vec<[u32; 2]>>,
    /// Place in a row of each column, for either half of the rows.
    marks: [Vec<u32>; 2],
}

impl Aggregation {
    /// Of a level with this pattern; returns the pattern of the coarse matrix too.
    pub(super) fn new(rows: &BlockRows, aggregates: Aggregates) -> (Self, BlockRows) {
        let Aggregates {
            is_strong,
            rigid,
            free,
            ..
        } = aggregates;
        let pattern = BlockRows::new((0..rows.count()).map(|row| {
            let strong = rows.range(row).filter(|&block| is_strong[block]);
            strong
                .flat_map(|block| rigid[rows.column(block)].map(|(node, _)| node))
                .collect()
        }));
        let products = rows.times(&pattern);
        let children = pattern.by_column(free.len());
        let coarse = BlockRows::new(children.iter().map(|children| {
            let mut columns = Vec::new();
            for [row, _] in children {
                columns.extend_from_slice(products.columns(*row as usize));
            }
            columns
        }));
        let found = Self {
            values: vec![Block::default(); pattern.blocks()],
            of_products: vec![Block::default(); products.blocks()],
            marks: [vec![0; free.len()], vec![0; free.len()]],
            is_strong,
            rigid,
            pattern,
            products,
            children,
        };
        (found, coarse)
    }

    /// Number of blocks of what is kept.
    pub(super) fn blocks(&self) -> usize {
        self.values.len() + self.of_products.len() + 2 * self.rigid.len()
    }

    /// Makes P, and the coarse matrix, of a matrix with the inverse of its diagonal blocks and a factor ω.
    pub(super) fn prepare(
        &mut self,
        (rows, matrix): (&BlockRows, &[Block]),
        inverse: &[Block],
        damping: f32,
        (coarse_rows, coarse): (&BlockRows, &mut [Block]),
    ) {
        let Self {
            is_strong,
            rigid,
            pattern,
            values,
            products,
            of_products,
            children,
            marks,
        } = self;
        each_row(pattern, values, marks, |row, own, marks| {
            for block in rows.range(row) {
                let from = if is_strong[block] {
                    rows.column(block)
                } else {
                    row
                };
                for (node, motion) in &rigid[from] {
                    let place = marks[*node as usize] as usize;
                    add_product(&mut own[place], &matrix[block], motion);
                }
            }
            for block in own.iter_mut() {
                let mut turned = Block::default();
                add_product(&mut turned, &inverse[row], block);
                *block = turned.map(|entry| -damping * entry);
            }
            for (node, motion) in &rigid[row] {
                let place = marks[*node as usize] as usize;
                for (entry, value) in own[place].iter_mut().zip(motion) {
                    *entry += value;
                }
            }
        });
        let (pattern, values) = (&*pattern, &*values);
        each_row(products, of_products, marks, |row, own, marks| {
            for block in rows.range(row) {
                for of_column in pattern.range(rows.column(block)) {
                    let place = marks[pattern.column(of_column)] as usize;
                    add_product(&mut own[place], &matrix[block], &values[of_column]);
                }
            }
        });
        let (products, of_products) = (&*products, &*of_products);
        each_row(coarse_rows, coarse, marks, |row, own, marks| {
            for &[child, block] in &children[row] {
                let weights = &values[block as usize];
                for product in products.range(child as usize) {
                    let place = marks[products.column(product)] as usize;
                    add_transposed_product(&mut own[place], weights, &of_products[product]);
                }
            }
        });
    }
}

/// Calls `write` with each row, its blocks as zeros, and the place of each of its columns; both halves of the rows at once.
fn each_row(
    pattern: &BlockRows,
    values: &mut [Block],
    marks: &mut [Vec<u32>; 2],
    write: impl Fn(usize, &mut [Block], &[u32]) + Sync,
) {
    let half = pattern.count() / 2;
    let (lower, upper) = values.split_at_mut(pattern.range(half).start);
    let of_rows = |rows: Range<usize>, values: &mut [Block], marks: &mut Vec<u32>| {
        let mut rest = values;
        for row in rows {
            let columns = pattern.columns(row);
            let (own, behind) = std::mem::take(&mut rest).split_at_mut(columns.len());
            rest = behind;
            for (place, column) in columns.iter().enumerate() {
                marks[*column as usize] = place as u32;
            }
            own.fill(Block::default());
            write(row, own, marks);
        }
    };
    let [a, b] = marks;
    join(
        || of_rows(0..half, lower, a),
        || of_rows(half..pattern.count(), upper, b),
    );
}
