//! The numeric part of a factorisation: front by front, with the remainder of each on a stack (Duff and Reid, 1983).

use pulp::Arch;

use super::dense::{Dense, padded};
use super::eliminate::{Count, Eliminate, Workspace};
use super::fronts::{Front, Fronts};
use super::graph::Progress;
use super::pivot::{Inertia, Rules};
use crate::math::Stopped;

/// Rows of a leaf of one column that is eliminated without a front.
const SHORT: usize = 32;

/// `L` and `D` of the last matrix, with the memory to make them.
#[derive(Clone, Debug, Default)]
pub(super) struct Factors {
    pub(super) blocks: Vec<Block>,
    /// Unknowns of all blocks.
    pub(super) unknowns: Vec<u32>,
    /// Columns of L below the diagonal, block by block.
    pub(super) columns: Vec<f64>,
    /// D⁻¹.
    pub(super) pivots: Vec<[f64; 2]>,
    /// Rows of the largest front.
    pub(super) largest: usize,
    /// Remainders of fronts that wait for their parents, square by columns.
    stack: Vec<f64>,
    /// Front under work.
    front: Vec<f64>,
    /// Places of the rows of a child.
    places: Vec<u32>,
    workspace: Workspace,
}

/// Columns eliminated in one front.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Block {
    /// Offset of its unknowns.
    pub(super) unknowns: usize,
    /// Offset of its columns.
    pub(super) columns: usize,
    /// Offset of its pivots.
    pub(super) pivots: usize,
    /// Rows of the front.
    pub(super) order: usize,
    /// Columns eliminated, the first rows.
    pub(super) eliminated: usize,
    /// Columns left to the parent, the rows behind.
    pub(super) delayed: usize,
    /// Offset of the remainder on the stack.
    remainder: usize,
}

impl Block {
    const fn left(&self) -> usize {
        self.order - self.eliminated
    }
}

/// Outcome of a factorisation.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Outcome {
    pub(super) inertia: Inertia,
    /// Columns that were left to a parent, once for each front.
    pub(super) delays: usize,
}

impl Factors {
    /// Factors the matrix with these entries. `None` if more columns than `most_delays` are delayed; there are no factors then, and none
    /// where it was stopped.
    pub(super) fn factor(
        &mut self,
        plan: &Fronts,
        entries: &[f64],
        rules: Rules,
        most_delays: usize,
        progress: &mut Progress<'_>,
    ) -> Result<Option<Outcome>, Stopped> {
        self.blocks.clear();
        self.unknowns.clear();
        self.columns.clear();
        self.pivots.clear();
        self.stack.clear();
        self.largest = 0;
        let mut outcome = Outcome::default();
        let arch = Arch::new();
        for front in &plan.list {
            progress.add(front.unknowns.len().pow(2))?;
            let is_leaf = front.children.is_empty() && front.columns == 1;
            let is_short = front.unknowns.len() <= SHORT && !front.is_root;
            let count = match is_leaf && is_short {
                true => self.leaf(plan, front, entries, rules),
                false => None,
            };
            let count = match count {
                Some(count) => count,
                None => self.front(arch, plan, front, entries, rules, progress)?,
            };
            let block = self.blocks.last().expect("a block for each front");
            self.largest = self.largest.max(block.order);
            outcome.inertia.negative += count.negative;
            outcome.inertia.zero += count.zero;
            outcome.delays += block.delayed;
            if outcome.delays > most_delays {
                return Ok(None);
            }
        }
        Ok(Some(outcome))
    }

    /// A front of one column and no children, without making it; `None` if its diagonal is no pivot.
    fn leaf(
        &mut self,
        plan: &Fronts,
        front: &Front,
        entries: &[f64],
        rules: Rules,
    ) -> Option<Count> {
        let rows = front.unknowns.len();
        let mut column = [0.0; SHORT];
        for entry in &plan.entries[front.entries.clone()] {
            column[entry.row as usize] += entries[entry.entry as usize];
        }
        let below = &column[1..rows];
        let most = below.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
        let diagonal = column[0];
        let is_pivot = diagonal.abs() > rules.zero && diagonal.abs() >= rules.threshold * most;
        if !is_pivot {
            return None;
        }
        let inverse = diagonal.recip();
        let block = Block {
            unknowns: self.unknowns.len(),
            columns: self.columns.len(),
            pivots: self.pivots.len(),
            order: rows,
            eliminated: 1,
            delayed: 0,
            remainder: self.stack.len(),
        };
        self.unknowns
            .extend_from_slice(&plan.unknowns[front.unknowns.clone()]);
        self.columns
            .extend(below.iter().map(|entry| entry * inverse));
        self.pivots.push([inverse, 0.0]);
        for (j, entry) in below.iter().enumerate() {
            let factor = -entry * inverse;
            self.stack.resize(self.stack.len() + j, 0.0);
            self.stack
                .extend(below[j..].iter().map(|entry| factor * entry));
        }
        self.blocks.push(block);
        Some(Count {
            eliminated: 1,
            negative: usize::from(diagonal < 0.0),
            zero: 0,
        })
    }

    fn front(
        &mut self,
        arch: Arch,
        plan: &Fronts,
        front: &Front,
        entries: &[f64],
        rules: Rules,
        progress: &mut Progress<'_>,
    ) -> Result<Count, Stopped> {
        let children = &plan.children[front.children.clone()];
        let delayed_to = |&child: &u32| self.blocks[child as usize].delayed;
        let delayed: usize = children.iter().map(delayed_to).sum();
        let order = front.unknowns.len() + delayed;
        let candidates = front.columns + delayed;
        let mut block = Block {
            unknowns: self.unknowns.len(),
            columns: self.columns.len(),
            pivots: self.pivots.len(),
            order,
            ..Block::default()
        };
        self.assemble(plan, front, entries, delayed, order);
        self.pivots.resize(block.pivots + candidates, [0.0; 2]);
        let stride = padded(order);
        let count = arch.dispatch(Eliminate {
            front: Dense {
                values: &mut self.front[..stride * order],
                order,
                stride,
                candidates,
                unknowns: &mut self.unknowns[block.unknowns..],
                pivots: &mut self.pivots[block.pivots..],
            },
            rules,
            is_root: front.is_root,
            workspace: &mut self.workspace,
            progress,
        })?;
        block.eliminated = count.eliminated;
        block.delayed = candidates - count.eliminated;
        self.pivots.truncate(block.pivots + count.eliminated);
        for q in 0..count.eliminated {
            let column = &self.front[q * stride..][q + 1..order];
            self.columns.extend_from_slice(column);
        }
        if let Some(&first) = children.first() {
            self.stack.truncate(self.blocks[first as usize].remainder);
        }
        block.remainder = self.stack.len();
        for q in count.eliminated..order {
            let column = &self.front[q * stride..][count.eliminated..order];
            self.stack.extend_from_slice(column);
        }
        self.blocks.push(block);
        Ok(count)
    }

    /// Sums the entries that begin in a front and the remainders of its children; columns delayed to it come first.
    fn assemble(
        &mut self,
        plan: &Fronts,
        front: &Front,
        entries: &[f64],
        delayed: usize,
        order: usize,
    ) {
        let stride = padded(order);
        let begin = self.unknowns.len();
        let size = stride * order;
        if self.front.len() < size {
            self.front.resize(size, 0.0);
        }
        let values = &mut self.front[..size];
        values.fill(0.0);
        for entry in &plan.entries[front.entries.clone()] {
            let (row, column) = (
                entry.row as usize + delayed,
                entry.column as usize + delayed,
            );
            values[row + column * stride] += entries[entry.entry as usize];
        }
        for &child in &plan.children[front.children.clone()] {
            let block = self.blocks[child as usize];
            let names = block.unknowns + block.eliminated;
            self.places.clear();
            let first = self.unknowns.len() - begin;
            self.places
                .extend((first..first + block.delayed).map(|place| place as u32));
            self.unknowns
                .extend_from_within(names..names + block.delayed);
            let below = &plan.places[plan.list[child as usize].places.clone()];
            self.places
                .extend(below.iter().map(|place| place + delayed as u32));
            let remainder = &self.stack[block.remainder..][..block.left() * block.left()];
            add(values, stride, remainder, &self.places);
        }
        self.unknowns
            .extend_from_slice(&plan.unknowns[front.unknowns.clone()]);
    }
}

/// Adds the lower triangle of a square to a front.
fn add(values: &mut [f64], stride: usize, square: &[f64], places: &[u32]) {
    if places.is_empty() {
        return;
    }
    for (j, column) in square.chunks_exact(places.len()).enumerate() {
        let target = &mut values[places[j] as usize * stride..][..stride];
        for (&place, &value) in places[j..].iter().zip(&column[j..]) {
            target[place as usize] += value;
        }
    }
}
