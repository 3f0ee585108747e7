//! Transfer by smoothed aggregation: P = (1 − ω D⁻¹ A) R, with the rigid motions R of aggregates, and the coarse matrix Pᵀ A P.
//!
//! In the factor of R weakly coupled neighbours move as the node itself does, so that P reaches no farther across thin layers.

use crate::math::join;
use crate::sparse::multigrid::aggregates::{Aggregates, Rigid};
use crate::sparse::multigrid::block_rows::BlockRows;
use crate::sparse::multigrid::mesh_matrix::MeshMatrix;
use crate::sparse::multigrid::node_grid::{Block, add_product, add_transposed_product};
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
    /// Work space of either half of the rows.
    marks: [Marks; 2],
}

/// A row, and the place in it of each of its columns.
#[derive(Debug)]
struct Marks {
    places: Vec<u32>,
    row: Vec<Block>,
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
            marks: [(); 2].map(|()| Marks {
                places: vec![0; free.len()],
                row: Vec::new(),
            }),
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
        fine: &MeshMatrix,
        inverse: &[Block],
        damping: f32,
        coarse: &mut MeshMatrix,
    ) {
        let rows = &fine.rows;
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
        let halves = in_two(values, pattern);
        each_row(pattern, halves, marks, |row, own, marks| {
            for (block, entries) in rows.range(row).zip(fine.row(row)) {
                let from = if is_strong[block] {
                    rows.column(block)
                } else {
                    row
                };
                for (node, motion) in &rigid[from] {
                    let place = marks[*node as usize] as usize;
                    add_product(&mut own[place], entries, motion);
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
        let halves = in_two(of_products, products);
        each_row(products, halves, marks, |row, own, marks| {
            for (column, entries) in rows.columns(row).iter().zip(fine.row(row)) {
                for of_column in pattern.range(*column as usize) {
                    let place = marks[pattern.column(of_column)] as usize;
                    add_product(&mut own[place], entries, &values[of_column]);
                }
            }
        });
        let (products, of_products) = (&*products, &*of_products);
        let coarse_rows = coarse.rows.clone();
        let halves = coarse.in_two().map(|mut rows| {
            let pattern = &coarse_rows;
            move |row: usize, blocks: &[Block]| {
                for (block, column) in blocks.iter().zip(pattern.columns(row)) {
                    *rows.next(row, *column as usize) = *block;
                }
            }
        });
        each_row(&coarse_rows, halves, marks, |row, own, marks| {
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

/// Writes rows one after the other to either half of the blocks of a pattern.
fn in_two<'v>(
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
fn each_row(
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
