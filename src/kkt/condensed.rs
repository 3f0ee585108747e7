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
//!
//! Work in two halves, on two threads where it is long.
//!
//! The halves depend on the system alone, so that factors are the same for any number of threads.

use crate::kkt::bandwidth_order::{Block, Item};
use crate::kkt::block_lu::{BlockLu, Room};
use crate::kkt::condense::Condensation;
use crate::kkt::graph::Progress;
use crate::kkt::numeric::{Factors, Outcome};
use crate::kkt::pivot::{Inertia, Rules};
use crate::kkt::reduce::{Reduce, Weights};
use crate::kkt::update::Product;
use crate::math::{Stopped, join_if};
use pulp::Arch;
use std::ops::Range;

/// Greatest response of a state against the greatest direct one. Beyond, what is left of R are errors of rounding;
/// free motions of a thousand stages stay below.
const GROWTH: f64 = 1e6;
/// Rules by which pivots of R are chosen.
const RULES: Rules = Rules {
    threshold: 0.1,
    zero: 1e-20,
};

/// Factors of the last matrix, with the memory to make them.
#[derive(Debug)]
pub(super) struct Condensed {
    pub(super) parts: Condensation,
    pub(super) blocks: Vec<BlockLu>,
    /// Number of blocks in the first half of the work, and memory of each half.
    middle: usize,
    rooms: [Room; 2],
    weights: [Weights; 2],
    /// S by rows, one for each state, and where each begins.
    pub(super) responses: Vec<f64>,
    pub(super) starts: Vec<usize>,
    /// Gᵀ of one block by rows, S by columns, and one column.
    rows: Vec<f64>,
    columns: Vec<f64>,
    pub(super) column: Vec<f64>,
    /// Sums of the entries at each place; the first one is of none.
    pub(super) values: Vec<f64>,
    entries: Vec<f64>,
    /// True if equations of the last matrix had a diagonal.
    pub(super) has_diagonal: bool,
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
        let blocks = parts.blocks.iter();
        let blocks: Vec<BlockLu> = blocks
            .map(|block| BlockLu::new(block.envelope.clone()))
            .collect();
        let most = |size: fn(&Block) -> usize| parts.blocks.iter().map(size).max().unwrap_or(0);
        let plans = parts.plans.iter();
        let entries = plans.map(|plan| plan.pattern().len()).max().unwrap_or(0);
        Self {
            middle: middle(parts.blocks.iter().map(Block::multiplications)),
            rooms: [0, 1].map(|_| Room::for_blocks(&blocks)),
            weights: [0, 1].map(|_| Weights::from_blocks(&parts.blocks)),
            blocks,
            responses: vec![0.0; starts[starts.len() - 1]],
            starts,
            rows: vec![0.0; most(|b| b.equations.len() * b.reach.len())],
            columns: vec![0.0; most(|b| b.states.len() * b.reach.len())],
            column: vec![0.0; most(|b| b.states.len())],
            values: vec![0.0; parts.count],
            entries: vec![0.0; entries],
            has_diagonal: false,
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
            progress.add(block.envelope.of_solution() * block.reach.len())?;
            self.respond(k);
        }
        if self.is_growing() {
            return Ok(None);
        }
        self.reduce(progress)?;
        let plan = &self.parts.plans[usize::from(self.has_diagonal)];
        let entries = &self.entries[..plan.pattern().len()];
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

    /// Factors all blocks; returns true if their equations are independent.
    fn factor_blocks(&mut self, progress: &mut Progress<'_>) -> Result<bool, Stopped> {
        progress.add(0)?;
        let (parts, values) = (&self.parts.blocks, &self.values);
        let work = |parts: &[Block],
                    blocks: &mut [BlockLu],
                    room: &mut Room,
                    progress: &mut Progress<'_>| {
            for (part, block) in parts.iter().zip(blocks) {
                progress.add(part.envelope.of_factors())?;
                block.clear();
                for item in &part.own {
                    let equation = item.row as usize - part.equations.start;
                    let state = item.column as usize - part.states.start;
                    block.add(equation, state, values[item.value as usize]);
                }
                if !block.factor(room) {
                    return Ok(false);
                }
            }
            Ok(true)
        };
        let parts_of = parts.split_at(self.middle);
        let blocks_of = self.blocks.split_at_mut(self.middle);
        let [room, other] = &mut self.rooms;
        let [mut first, mut second] = progress.halves();
        let (a, b) = halves(
            parts.iter().map(|part| part.envelope.of_factors()).sum(),
            || work(parts_of.0, blocks_of.0, room, &mut first),
            || work(parts_of.1, blocks_of.1, other, &mut second),
        );
        Ok(a? && b?)
    }

    /// S of one block: by halves of its equations, then of its columns.
    fn respond(&mut self, k: usize) {
        let (part, block) = (&self.parts.blocks[k], &self.blocks[k]);
        let (n, e, width) = (part.states.len(), part.equations.len(), part.reach.len());
        if width == 0 {
            return;
        }
        let direct = width - part.free();
        let rows = &mut self.rows[..e * width];
        let half = e / 2;
        let (values, responses, starts) = (&self.values, &self.responses, &self.starts);
        let right_hand_sides = |first: usize, rows: &mut [f64]| {
            let equations =
                part.equations.start + first..part.equations.start + first + rows.len() / width;
            rows.fill(0.0);
            Arch::new().dispatch(Product {
                items: of_rows(&part.below, &equations),
                values,
                from: responses,
                starts,
                to: rows,
                first: equations.start,
                width,
            });
            for item in of_rows(&part.inputs, &equations) {
                let row = item.row as usize - equations.start;
                rows[row * width + item.place as usize] -= values[item.value as usize];
            }
        };
        let (upper, lower) = rows.split_at_mut(half * width);
        halves(
            part.below.len() * width,
            || right_hand_sides(0, upper),
            || right_hand_sides(half, lower),
        );
        let rows = &*rows;
        let solve = |first: usize, columns: &mut [f64]| {
            for (j, column) in columns.chunks_exact_mut(n).enumerate() {
                for (value, row) in column.iter_mut().zip(rows.chunks_exact(width)) {
                    *value = row[first + j];
                }
            }
            block.solve(columns);
        };
        let columns = &mut self.columns[..n * width];
        let (determined, free) = columns.split_at_mut(n * direct);
        let half = direct / 2;
        let (left, right) = determined.split_at_mut(n * half);
        halves(
            part.envelope.of_solution() * direct,
            || solve(0, left),
            || solve(half, right),
        );
        block.free(free);
        let own = self.starts[part.states.start]..self.starts[part.states.end];
        for (i, row) in self.responses[own].chunks_exact_mut(width).enumerate() {
            for (j, value) in row.iter_mut().enumerate() {
                *value = columns[i + j * n];
            }
        }
    }

    /// Returns true if responses by way of earlier blocks are out of proportion to direct ones, or not finite.
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

    /// R: what each block adds, and M.
    fn reduce(&mut self, progress: &mut Progress<'_>) -> Result<(), Stopped> {
        progress.add(0)?;
        let (parts, middle) = (&self.parts.blocks, self.middle);
        let plain = self.parts.plans[0].pattern().len();
        let counts = [0..middle, middle..parts.len()].map(|half| {
            let of_half = parts[half].iter();
            of_half.fold([0, 0], |[responses, diagonals], part| {
                [responses + part.responses(), diagonals + part.squares()]
            })
        });
        let (entries, diagonals) = self.entries.split_at_mut(plain);
        let (left, right) = entries.split_at_mut(counts[0][0]);
        let (right, corner) = right.split_at_mut(counts[1][0]);
        let (left_diagonals, right_diagonals) = match self.has_diagonal {
            true => diagonals.split_at_mut(counts[0][1]),
            false => Default::default(),
        };
        let half = |blocks: Range<usize>| Reduce {
            parts: &parts[blocks.clone()],
            blocks: &self.blocks[blocks],
            values: &self.values,
            responses: &self.responses,
            starts: &self.starts,
            has_diagonal: self.has_diagonal,
        };
        let (first, second) = (half(0..middle), half(middle..parts.len()));
        let [weights, other] = &mut self.weights;
        let [mut before, mut behind] = progress.halves();
        let (a, b) = halves(
            parts.iter().map(Reduce::multiplications).sum(),
            || first.run(weights, left, left_diagonals, &mut before),
            || second.run(other, right, right_diagonals, &mut behind),
        );
        a.and(b)?;
        for (to, item) in corner.iter_mut().zip(&self.parts.corner) {
            *to = self.values[item.value as usize];
        }
        for &at in &self.parts.twice {
            self.entries[at as usize] *= 2.0;
        }
        Ok(())
    }
}

/// Items of these rows, of items row by row.
fn of_rows<'a>(items: &'a [Item], rows: &Range<usize>) -> &'a [Item] {
    let before = |row: usize| items.partition_point(|item| (item.row as usize) < row);
    &items[before(rows.start)..before(rows.end)]
}

/// Multiplications below which a second core is not worth being woken: some milliseconds.
const MUCH: usize = 1 << 23;

/// Does both halves of this number of multiplications.
pub(super) fn halves<A: Send, B: Send>(
    multiplications: usize,
    a: impl FnOnce() -> A + Send,
    b: impl FnOnce() -> B + Send,
) -> (A, B) {
    join_if(multiplications >= MUCH, a, b)
}

/// Returns the number of items of the first half, of items with these costs.
pub(super) fn middle(costs: impl Iterator<Item = f64> + Clone) -> usize {
    let half = 0.5 * costs.clone().sum::<f64>();
    let sums = costs.scan(0.0, |sum, cost| {
        *sum += cost;
        Some(*sum)
    });
    sums.take_while(|sum| *sum <= half).count()
}
