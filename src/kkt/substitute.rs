//! Solution with the factors of a condensed system.

use crate::kkt::bandwidth_order::Item;
use crate::kkt::condensed::Condensed;
use crate::kkt::dense::{dot, subtract};
use crate::kkt::numeric::{Block, Factors};
use pulp::{Arch, Simd, WithSimd};

impl Condensed {
    /// Replaces a right-hand side by the solution.
    pub(super) fn solve(&mut self, x: &mut [f64]) {
        let arch = Arch::new();
        arch.dispatch(Forward(self, x));
        solve(&self.factors, &mut self.reduced, &mut self.work);
        arch.dispatch(Backward(self, x));
    }
}

/// Forward pass: from the right-hand side to that of the reduced system.
struct Forward<'a>(&'a mut Condensed, &'a [f64]);

impl WithSimd for Forward<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, unit: S) {
        let Self(system, x) = self;
        system.determine(unit, x);
        system.gradient(x);
        if system.has_diagonal {
            system.first_multipliers.fill(0.0);
            system.correct(unit);
            system.gradient(x);
        }
        system.respond_transposed(unit, x);
    }
}

/// Backward pass: from the reduced unknowns to all.
struct Backward<'a>(&'a mut Condensed, &'a mut [f64]);

impl WithSimd for Backward<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, unit: S) {
        let Self(system, x) = self;
        system.respond_to_reduced(unit);
        system.gradient(x);
        system.couple();
        if system.has_diagonal {
            system.correct(unit);
            system.gradient(x);
            system.couple();
        }
        system.multiply(unit);
        scatter(&system.states, &system.parts.states, x);
        scatter(&system.multipliers, &system.parts.equations, x);
        scatter(&system.reduced, &system.parts.rest, x);
    }
}

/// Steps of a solution. All of them are inlined where the vector unit is known.
impl Condensed {
    /// s₀: what the equations determine where all reduced unknowns are zero.
    #[inline(always)]
    fn determine<S: Simd>(&mut self, unit: S, x: &[f64]) {
        self.states.fill(0.0);
        for (k, block) in self.parts.blocks.iter().enumerate() {
            let right = &mut self.column[..block.states.len()];
            let equations = &self.parts.equations[block.equations.clone()];
            gather(x, equations, right);
            for item in &block.below {
                let row = item.row as usize - block.equations.start;
                right[row] -= value(&self.values, item) * self.states[item.column as usize];
            }
            self.blocks[k].solve_one(unit, right);
            self.states[block.states.clone()].copy_from_slice(right);
        }
    }

    /// r_s − H s.
    #[inline(always)]
    fn gradient(&mut self, x: &[f64]) {
        let (values, states, to) = (&self.values, &self.states, &mut self.gradient);
        gather(x, &self.parts.states, to);
        for block in &self.parts.blocks {
            for row in block.curvature.chunk_by(|a, b| a.row == b.row) {
                let own = row[0].row as usize;
                let mut sum = 0.0;
                for item in row {
                    let (value, column) = (value(values, item), item.column as usize);
                    sum += value * states[column];
                    to[column] -= value * states[own];
                }
                // What stands on the diagonal comes last, and was subtracted as a column.
                let last = &row[row.len() - 1];
                if last.column == last.row {
                    sum -= value(values, last) * states[own];
                }
                to[own] -= sum;
            }
        }
    }

    /// r_s − H s − Kᵀ w.
    #[inline(always)]
    fn couple(&mut self) {
        for item in self.parts.blocks.iter().flat_map(|b| &b.coupling) {
            let reduced = self.reduced[item.column as usize];
            self.gradient[item.row as usize] -= value(&self.values, item) * reduced;
        }
    }

    /// Corrects states where equations have a diagonal E and determine `s − A_D⁻¹ E y`: for multipliers that follow from the gradient at hand,
    /// and that were others before.
    #[inline(always)]
    fn correct<S: Simd>(&mut self, unit: S) {
        for (k, block) in self.parts.blocks.iter().enumerate() {
            if block.diagonal.is_empty() {
                continue;
            }
            let equations = block.equations.clone();
            let change = &mut self.column[..block.states.len()];
            change.copy_from_slice(&self.gradient[block.states.clone()]);
            self.blocks[k].solve_one_transposed(unit, change);
            let before = &mut self.first_multipliers[equations.clone()];
            let mut next = 0;
            for item in &block.diagonal {
                let row = item.row as usize - equations.start;
                change[next..row].fill(0.0);
                let now = std::mem::replace(&mut before[row], change[row]);
                change[row] = value(&self.values, item) * (before[row] - now);
                next = row + 1;
            }
            change[next..].fill(0.0);
            self.blocks[k].solve_one(unit, change);
            for (state, change) in self.states[block.states.clone()].iter_mut().zip(change) {
                *state -= *change;
            }
        }
    }

    /// r_w − K s₀ + Sᵀ (r_s − H s₀).
    #[inline(always)]
    fn respond_transposed<S: Simd>(&mut self, unit: S, x: &[f64]) {
        let rest = self.parts.rest.len();
        gather(x, &self.parts.rest, &mut self.reduced[..rest]);
        self.reduced[rest..].fill(0.0);
        for item in self.parts.blocks.iter().flat_map(|b| &b.coupling) {
            let state = self.states[item.row as usize];
            self.reduced[item.column as usize] -= value(&self.values, item) * state;
        }
        for block in self.parts.blocks.iter().filter(|b| !b.reach.is_empty()) {
            self.work.clear();
            self.work.resize(block.reach.len(), 0.0);
            let rows = self.starts[block.states.start]..self.starts[block.states.end];
            let rows = self.responses[rows].chunks_exact(block.reach.len());
            for (row, gradient) in rows.zip(&self.gradient[block.states.clone()]) {
                subtract(unit, &mut self.work, row, -gradient);
            }
            for (&i, sum) in block.reach.iter().zip(&self.work) {
                self.reduced[i as usize] += sum;
            }
        }
    }

    /// s₀ + S w.
    #[inline(always)]
    fn respond_to_reduced<S: Simd>(&mut self, unit: S) {
        for block in self.parts.blocks.iter().filter(|b| !b.reach.is_empty()) {
            self.work.clear();
            let reduced = block.reach.iter().map(|&i| self.reduced[i as usize]);
            self.work.extend(reduced);
            let rows = self.starts[block.states.start]..self.starts[block.states.end];
            let rows = self.responses[rows].chunks_exact(block.reach.len());
            for (row, state) in rows.zip(&mut self.states[block.states.clone()]) {
                *state += dot(unit, row, &self.work);
            }
        }
    }

    /// y of `A_Dᵀ y = r_s − H s − Kᵀ w`.
    #[inline(always)]
    fn multiply<S: Simd>(&mut self, unit: S) {
        for (k, block) in self.parts.blocks.iter().enumerate().rev() {
            let column = &mut self.column[..block.states.len()];
            column.copy_from_slice(&self.gradient[block.states.clone()]);
            self.blocks[k].solve_one_transposed(unit, column);
            let multipliers = &mut self.multipliers[block.equations.clone()];
            multipliers.copy_from_slice(&column[..block.equations.len()]);
            for item in &block.below {
                let row = item.row as usize - block.equations.start;
                self.gradient[item.column as usize] -= value(&self.values, item) * multipliers[row];
            }
        }
    }
}

fn value(values: &[f64], item: &Item) -> f64 {
    values[item.value as usize]
}

#[inline(always)]
fn gather(x: &[f64], unknowns: &[u32], to: &mut [f64]) {
    for (value, &i) in to.iter_mut().zip(unknowns) {
        *value = x[i as usize];
    }
}

#[inline(always)]
fn scatter(from: &[f64], unknowns: &[u32], x: &mut [f64]) {
    for (value, &i) in from.iter().zip(unknowns) {
        x[i as usize] = *value;
    }
}

/// Replaces a right-hand side by the solution; `work` holds the largest front.
pub(super) fn solve(factors: &Factors, x: &mut [f64], work: &mut Vec<f64>) {
    if work.len() < factors.largest {
        work.resize(factors.largest, 0.0);
    }
    Arch::new().dispatch(Solve { factors, x, work });
}

struct Solve<'a> {
    factors: &'a Factors,
    x: &'a mut [f64],
    work: &'a mut [f64],
}

impl WithSimd for Solve<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, unit: S) {
        let Solve { factors, x, work } = self;
        for block in &factors.blocks {
            forward(unit, factors, block, x, work);
        }
        for block in factors.blocks.iter().rev() {
            backward(unit, factors, block, x, work);
        }
    }
}

/// `L y = b` on the rows of one block.
#[inline(always)]
fn forward<S: Simd>(unit: S, factors: &Factors, block: &Block, x: &mut [f64], work: &mut [f64]) {
    let unknowns = &factors.unknowns[block.unknowns..][..block.order];
    let work = &mut work[..block.order];
    gather(x, unknowns, work);
    let mut columns = &factors.columns[block.columns..];
    for j in 0..block.eliminated {
        let (pivot, below) = work[j..].split_first_mut().expect("a row for each column");
        let (column, rest) = columns.split_at(below.len());
        subtract(unit, below, column, *pivot);
        columns = rest;
    }
    scatter(work, unknowns, x);
}

/// `D Lᵀ x = y` on the rows of one block.
#[inline(always)]
fn backward<S: Simd>(unit: S, factors: &Factors, block: &Block, x: &mut [f64], work: &mut [f64]) {
    let unknowns = &factors.unknowns[block.unknowns..][..block.order];
    let work = &mut work[..block.order];
    gather(x, unknowns, work);
    let count = block.eliminated;
    divide(&factors.pivots[block.pivots..][..count], &mut work[..count]);
    let length = |j: usize| block.order - j - 1;
    let total: usize = (0..count).map(length).sum();
    let mut columns = &factors.columns[block.columns..][..total];
    for j in (0..count).rev() {
        let (rest, column) = columns.split_at(columns.len() - length(j));
        let (pivot, below) = work[j..].split_first_mut().expect("a row for each column");
        *pivot -= dot(unit, column, below);
        columns = rest;
    }
    scatter(work, &unknowns[..count], x);
}

/// `x ← D⁻¹ x`.
#[inline(always)]
fn divide(pivots: &[[f64; 2]], x: &mut [f64]) {
    let mut j = 0;
    while j < x.len() {
        let [diagonal, below] = pivots[j];
        if below == 0.0 {
            x[j] *= diagonal;
            j += 1;
        } else {
            let (y, z) = (x[j], x[j + 1]);
            x[j] = diagonal * y + below * z;
            x[j + 1] = below * y + pivots[j + 1][0] * z;
            j += 2;
        }
    }
}
