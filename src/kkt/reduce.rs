//! Contributions of blocks to the reduced system R: each one `Sᵀ W` and its transpose, with W = ½ H S of its own states, H S of earlier ones, and
//! Kᵀ.

use faer::linalg::matmul::matmul;
use faer::{Accum, MatMut, MatRef, Par};
use pulp::Arch;

use super::bandwidth_order::Block;
use super::block_lu::BlockLu;
use super::graph::Progress;
use super::update::Curvature;
use crate::math::Stopped;

/// Blocks one behind the other, whose responses are known.
#[derive(Clone, Copy)]
pub(super) struct Reduce<'a> {
    pub(super) parts: &'a [Block],
    pub(super) blocks: &'a [BlockLu],
    pub(super) values: &'a [f64],
    /// S by rows, one for each state, and where each begins.
    pub(super) responses: &'a [f64],
    pub(super) starts: &'a [usize],
    pub(super) has_diagonal: bool,
}

/// Memory for the products of one block after the other.
#[derive(Debug)]
pub(super) struct Weights {
    /// W by rows.
    rows: Vec<f64>,
    columns: Vec<f64>,
    /// `Xᵀ E X`.
    square: Vec<f64>,
}

impl Weights {
    /// For any of these blocks.
    pub(super) fn from_blocks(parts: &[Block]) -> Self {
        let most = |size: fn(&Block) -> usize| vec![0.0; parts.iter().map(size).max().unwrap_or(0)];
        Self {
            rows: most(|b| b.states.len() * b.weighted.len()),
            columns: most(|b| b.states.len() * b.weighted.len()),
            square: most(|b| b.weighted.len().pow(2)),
        }
    }
}

impl Block {
    /// Entries that it adds to the reduced system: pairs of `reach` and `weighted`.
    pub(super) fn responses(&self) -> usize {
        self.reach.len() * self.weighted.len()
    }

    /// Those that it adds where its equations have a diagonal: pairs of two of `weighted`, each once.
    pub(super) fn squares(&self) -> usize {
        match self.diagonal.is_empty() {
            true => 0,
            false => self.weighted.len() * (self.weighted.len() + 1) / 2,
        }
    }
}

impl Reduce<'_> {
    pub(super) fn multiplications(part: &Block) -> usize {
        part.states.len() * part.reach.len() * part.weighted.len()
    }

    /// Writes what the blocks add: one entry for each pair of `reach` and `weighted`, and of two of `weighted` where equations have a diagonal.
    pub(super) fn run(
        self,
        weights: &mut Weights,
        mut responses: &mut [f64],
        mut diagonals: &mut [f64],
        progress: &mut Progress<'_>,
    ) -> Result<(), Stopped> {
        for (part, block) in self.parts.iter().zip(self.blocks) {
            progress.add(Self::multiplications(part))?;
            self.weigh(part, &mut weights.rows);
            let (to, behind) = responses.split_at_mut(part.responses());
            self.add_responses(part, &weights.rows, to);
            responses = behind;
            if self.has_diagonal {
                let (to, behind) = diagonals.split_at_mut(part.squares());
                if !to.is_empty() {
                    self.add_diagonal(part, block, weights, to);
                }
                diagonals = behind;
            }
        }
        Ok(())
    }

    /// W of one block.
    fn weigh(&self, part: &Block, rows: &mut [f64]) {
        let width = part.weighted.len();
        let rows = &mut rows[..part.states.len() * width];
        rows.fill(0.0);
        Arch::new().dispatch(Curvature {
            block: part,
            values: self.values,
            from: self.responses,
            starts: self.starts,
            to: rows,
        });
        for item in &part.coupling {
            let row = item.row as usize - part.states.start;
            rows[row * width + item.place as usize] += self.values[item.value as usize];
        }
    }

    /// `Sᵀ W` of one block.
    fn add_responses(&self, part: &Block, rows: &[f64], to: &mut [f64]) {
        if to.is_empty() {
            return;
        }
        let (n, reach, width) = (part.states.len(), part.reach.len(), part.weighted.len());
        let own = self.starts[part.states.start]..self.starts[part.states.end];
        matmul(
            MatMut::from_row_major_slice_mut(to, reach, width),
            Accum::Replace,
            MatRef::from_row_major_slice(&self.responses[own], n, reach).transpose(),
            MatRef::from_row_major_slice(&rows[..n * width], n, width),
            1.0,
            Par::Seq,
        );
    }

    /// `Xᵀ E X` of one block whose equations have the diagonal E, with `X = A_D⁻ᵀ W_D`.
    fn add_diagonal(&self, part: &Block, block: &BlockLu, weights: &mut Weights, to: &mut [f64]) {
        let (n, e, width) = (part.states.len(), part.equations.len(), part.weighted.len());
        let Weights {
            rows,
            columns,
            square,
        } = weights;
        let columns = &mut columns[..n * width];
        for (i, row) in rows[..n * width].chunks_exact(width).enumerate() {
            for (j, value) in row.iter().enumerate() {
                columns[i + j * n] = *value;
            }
        }
        block.solve_transposed(columns);
        let scaled = &mut rows[..e * width];
        scaled.fill(0.0);
        for item in &part.diagonal {
            let value = self.values[item.value as usize];
            let first = item.row as usize - part.equations.start;
            for j in 0..width {
                scaled[first + j * e] = value * columns[first + j * n];
            }
        }
        let square = &mut square[..width * width];
        matmul(
            MatMut::from_row_major_slice_mut(square, width, width),
            Accum::Replace,
            MatRef::from_column_major_slice_with_stride(columns, e, width, n).transpose(),
            MatRef::from_column_major_slice(scaled, e, width),
            1.0,
            Par::Seq,
        );
        let mut end = 0;
        for (i, row) in square.chunks_exact(width).enumerate() {
            to[end..=end + i].copy_from_slice(&row[..=i]);
            end += i + 1;
        }
    }
}
