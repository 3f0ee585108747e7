//! Factors of a condensed system: states by reduced unknowns, then these by themselves.
//!
//! The equations give `s = s₀ + S w`, group by group: `S = −A_D⁻¹ [Gᵀ A_F]` of the states that they determine, and one for those that
//! are left over. What is left of the reduced unknowns is
//!
//! ```text
//! R = M + K S + Sᵀ Kᵀ + Sᵀ H S,
//! ```
//!
//! and by Haynsworth's law the inertia is that of R with one negative and one positive eigenvalue for each equation. Where equations have a
//! diagonal E and states no curvature of their own, `s = s₀ + S w − A_D⁻¹ E y` and `y = A_D⁻ᵀ (r_s − W w)`: R has `Wᵀ A_D⁻¹ E A_D⁻ᵀ W` in addition, with W
//! the rows of `H S + Kᵀ` of the states determined.

use faer::linalg::matmul::matmul;
use faer::{Accum, MatMut, MatRef, Par};
use pulp::Arch;

use super::block_lu::BlockLu;
use super::condense::{Block, Condensation};
use super::inertia::Inertia;
use super::numeric::{Factors, Outcome};
use super::pivot::Rules;
use super::products::{Curvature, Product};
use super::progress::{Progress, Stopped};

/// Greatest response of a state against the greatest direct one. Beyond, what is left of R are errors of rounding;
/// free motions of a thousand stages stay below.
const GROWTH: f64 = 1e6;
/// How pivots of R are chosen.
const RULES: Rules = Rules {
    threshold: 0.1,
    zero: 1e-20,
};

/// Factors of the last matrix, with the memory to make them.
#[derive(Debug)]
pub(super) struct Condensed {
    pub(super) parts: Condensation,
    pub(super) blocks: BlockLu,
    /// S by rows, one for each state, and where each begins.
    pub(super) responses: Vec<f64>,
    pub(super) starts: Vec<usize>,
    /// Gᵀ, and H S + Kᵀ, of one block by rows; and right-hand sides of one block by columns.
    rows: Vec<f64>,
    columns: Vec<f64>,
    /// Sums of the entries at each place; the first one is of none.
    pub(super) values: Vec<f64>,
    entries: Vec<f64>,
    /// Whether equations of the last matrix had a diagonal.
    pub(super) has_diagonal: bool,
    /// `Xᵀ E X` of one block.
    square: Vec<f64>,
    pub(super) factors: Factors,
    pub(super) work: Vec<f64>,
    /// States, gradients by states, multipliers of the equations, and reduced unknowns.
    pub(super) states: Vec<f64>,
    pub(super) gradient: Vec<f64>,
    pub(super) multipliers: Vec<f64>,
    pub(super) first_multipliers: Vec<f64>,
    pub(super) reduced: Vec<f64>,
}

impl Condensed {
    pub(super) fn new(parts: Condensation) -> Self {
        let mut starts = vec![0];
        for block in &parts.blocks {
            for _ in block.states.clone() {
                starts.push(starts[starts.len() - 1] + block.reach.len());
            }
        }
        let shapes = parts.blocks.iter();
        let shapes = shapes.map(|block| (block.equations.len(), block.states.len()));
        let most = |size: fn(&Block) -> usize| parts.blocks.iter().map(size).max().unwrap_or(0);
        let most_rows = most(|b| b.states.len() * b.reach.len().max(b.weighted.len()));
        let most_columns = most(|b| b.equations.len() * b.reach.len().max(b.weighted.len()));
        let plans = parts.plans.iter();
        let entries = plans.map(|plan| plan.pattern().0.len()).max().unwrap_or(0);
        Self {
            blocks: BlockLu::new(shapes),
            responses: vec![0.0; starts[starts.len() - 1]],
            starts,
            rows: vec![0.0; most_rows],
            columns: vec![0.0; most_columns],
            values: vec![0.0; parts.count],
            entries: vec![0.0; entries],
            has_diagonal: false,
            square: vec![0.0; most(|b| b.weighted.len() * b.weighted.len())],
            factors: Factors::default(),
            work: Vec::new(),
            states: vec![0.0; parts.states.len()],
            gradient: vec![0.0; parts.states.len()],
            multipliers: vec![0.0; parts.equations.len()],
            first_multipliers: vec![0.0; parts.equations.len()],
            reduced: vec![0.0; parts.plans[0].order()],
            parts,
        }
    }

    /// Factors the matrix with these entries; `None` where the equations hold more than they may, depend on each other, or responses
    /// grow along the horizon.
    pub(super) fn factor(
        &mut self,
        entries: &[f64],
        progress: &mut Progress<'_>,
    ) -> Result<Option<Outcome>, Stopped> {
        let mut zeros = self.parts.zeros.iter();
        if zeros.any(|&entry| entries[entry as usize] != 0.0) {
            return Ok(None);
        }
        self.values.fill(0.0);
        for (&value, entry) in self.parts.values.iter().zip(entries) {
            self.values[value as usize] += entry;
        }
        let mut diagonals = self.parts.blocks.iter().flat_map(|b| &b.diagonal);
        self.has_diagonal = diagonals.any(|item| self.values[item.value as usize] != 0.0);
        let mut exclusive = self.parts.exclusive.iter();
        let is_excluded = exclusive.any(|&entry| entries[entry as usize] != 0.0);
        if self.has_diagonal && is_excluded || !self.factor_blocks(progress)? {
            return Ok(None);
        }
        for k in 0..self.parts.blocks.len() {
            let block = &self.parts.blocks[k];
            progress.add(block.equations.len().pow(2) * block.reach.len())?;
            self.respond(k);
        }
        if self.is_growing() {
            return Ok(None);
        }
        self.reduce(progress)?;
        let plan = &self.parts.plans[usize::from(self.has_diagonal)];
        let entries = &self.entries[..plan.pattern().0.len()];
        if !entries.iter().all(|entry| entry.is_finite()) {
            return Ok(None);
        }
        let factors = &mut self.factors;
        let outcome = factors.factor(plan, entries, RULES, usize::MAX, progress)?;
        Ok(outcome.map(|outcome| Outcome {
            inertia: Inertia {
                negative: outcome.inertia.negative + self.parts.equations.len(),
                ..outcome.inertia
            },
            ..outcome
        }))
    }

    /// Whether the equations of all blocks are independent.
    fn factor_blocks(&mut self, progress: &mut Progress<'_>) -> Result<bool, Stopped> {
        self.blocks.clear();
        for (k, block) in self.parts.blocks.iter().enumerate() {
            progress.add(block.equations.len().pow(2) * block.states.len() / 2)?;
            for item in &block.own {
                let equation = item.row as usize - block.equations.start;
                let state = item.column as usize - block.states.start;
                let value = self.values[item.value as usize];
                self.blocks.add(k, equation, state, value);
            }
            if !self.blocks.factor(k) {
                return Ok(false);
            }
        }
        Ok(true)
    }

    /// S of one block.
    fn respond(&mut self, k: usize) {
        let block = &self.parts.blocks[k];
        let (e, width) = (block.equations.len(), block.reach.len());
        if width == 0 {
            return;
        }
        let (direct, rows) = (width - block.free(), &mut self.rows[..e * width]);
        rows.fill(0.0);
        Arch::new().dispatch(Product {
            items: &block.below,
            values: &self.values,
            from: &self.responses,
            starts: &self.starts,
            to: rows,
            first: block.equations.start,
            width,
        });
        for item in &block.inputs {
            let row = item.row as usize - block.equations.start;
            rows[row * width + item.place as usize] -= self.values[item.value as usize];
        }
        let columns = &mut self.columns[..e * width];
        for (i, row) in rows.chunks_exact(width).enumerate() {
            for (j, value) in row[..direct].iter().enumerate() {
                columns[i + j * e] = *value;
            }
        }
        let (determined, free) = columns.split_at_mut(e * direct);
        self.blocks.solve(k, determined);
        self.blocks.free(k, free);
        free.iter_mut().for_each(|value| *value = -*value);
        for (i, &state) in self.blocks.order(k).iter().enumerate() {
            let start = self.starts[block.states.start + state];
            let row = &mut self.responses[start..start + width];
            row.fill(0.0);
            if i < e {
                for (j, value) in row.iter_mut().enumerate() {
                    *value = columns[i + j * e];
                }
            } else {
                row[direct + i - e] = 1.0;
            }
        }
    }

    /// Whether responses by way of earlier blocks are out of proportion to direct ones, or no numbers.
    fn is_growing(&self) -> bool {
        let (mut direct, mut greatest): (f64, f64) = (0.0, 0.0);
        for block in self.parts.blocks.iter().filter(|b| !b.reach.is_empty()) {
            let rows = self.starts[block.states.start]..self.starts[block.states.end];
            for row in self.responses[rows].chunks_exact(block.reach.len()) {
                let most = |list: &[f64]| list.iter().fold(0.0, |most: f64, s| most.max(s.abs()));
                direct = direct.max(most(&row[block.inherited..]));
                greatest = greatest.max(most(row));
            }
        }
        greatest > GROWTH * direct || !greatest.is_finite()
    }

    /// R: each block adds `Sᵀ W` and its transpose, with W = ½ H S of its own states, H S of earlier ones, and Kᵀ.
    fn reduce(&mut self, progress: &mut Progress<'_>) -> Result<(), Stopped> {
        let plain = self.parts.plans[0].pattern().0.len();
        let (mut end, mut end_of_diagonals) = (0, plain);
        for k in 0..self.parts.blocks.len() {
            let block = &self.parts.blocks[k];
            progress.add(block.states.len() * block.reach.len() * block.weighted.len())?;
            self.weigh(k);
            end = self.add_responses(k, end);
            if self.has_diagonal {
                end_of_diagonals = self.add_diagonal(k, end_of_diagonals);
            }
        }
        for (to, item) in self.entries[end..plain].iter_mut().zip(&self.parts.corner) {
            *to = self.values[item.value as usize];
        }
        for &at in &self.parts.twice {
            self.entries[at as usize] *= 2.0;
        }
        Ok(())
    }

    /// W of one block, in `rows`.
    fn weigh(&mut self, k: usize) {
        let block = &self.parts.blocks[k];
        let width = block.weighted.len();
        let rows = &mut self.rows[..block.states.len() * width];
        rows.fill(0.0);
        Arch::new().dispatch(Curvature {
            block,
            values: &self.values,
            from: &self.responses,
            starts: &self.starts,
            to: rows,
        });
        for item in &block.coupling {
            let row = item.row as usize - block.states.start;
            rows[row * width + item.place as usize] += self.values[item.value as usize];
        }
    }

    /// `Sᵀ W` of one block, the entries from `begin` on; where they end.
    fn add_responses(&mut self, k: usize, begin: usize) -> usize {
        let block = &self.parts.blocks[k];
        let (n, reach, width) = (block.states.len(), block.reach.len(), block.weighted.len());
        let end = begin + reach * width;
        let own = self.starts[block.states.start]..self.starts[block.states.end];
        if begin < end {
            matmul(
                MatMut::from_row_major_slice_mut(&mut self.entries[begin..end], reach, width),
                Accum::Replace,
                MatRef::from_row_major_slice(&self.responses[own], n, reach).transpose(),
                MatRef::from_row_major_slice(&self.rows[..n * width], n, width),
                1.0,
                Par::Seq,
            );
        }
        end
    }

    /// `Xᵀ E X` of one block whose equations have the diagonal E, with `X = A_D⁻ᵀ W_D`; where its entries end.
    fn add_diagonal(&mut self, k: usize, begin: usize) -> usize {
        let block = &self.parts.blocks[k];
        let (e, width) = (block.equations.len(), block.weighted.len());
        if block.diagonal.is_empty() || width == 0 {
            return begin;
        }
        let (rows, columns) = (&mut self.rows, &mut self.columns[..e * width]);
        for (i, &state) in self.blocks.order(k)[..e].iter().enumerate() {
            for (j, value) in rows[state * width..][..width].iter().enumerate() {
                columns[i + j * e] = *value;
            }
        }
        self.blocks.solve_transposed(k, columns);
        let scaled = &mut rows[..e * width];
        scaled.fill(0.0);
        for item in &block.diagonal {
            let value = self.values[item.value as usize];
            let first = item.row as usize - block.equations.start;
            for i in (first..e * width).step_by(e) {
                scaled[i] = value * columns[i];
            }
        }
        let square = &mut self.square[..width * width];
        matmul(
            MatMut::from_row_major_slice_mut(square, width, width),
            Accum::Replace,
            MatRef::from_column_major_slice(columns, e, width).transpose(),
            MatRef::from_column_major_slice(scaled, e, width),
            1.0,
            Par::Seq,
        );
        let mut end = begin;
        for (i, row) in square.chunks_exact(width).enumerate() {
            self.entries[end..=end + i].copy_from_slice(&row[..=i]);
            end += i + 1;
        }
        end
    }
}
