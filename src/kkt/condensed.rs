//! Factors of a condensed system: states by inputs, then the rest by itself.
//!
//! The equations give `s = s₀ + S w` with `S = −A⁻¹ Gᵀ`, stage by stage. What is left of the rest is
//!
//! ```text
//! R = M + K S + Sᵀ Kᵀ + Sᵀ H S,
//! ```
//!
//! and by Haynsworth's law the inertia is that of R with one negative and one positive eigenvalue for each state.

use faer::linalg::matmul::matmul;
use faer::{Accum, MatMut, MatRef, Par};
use pulp::{Arch, Simd, WithSimd};

use super::block_lu::BlockLu;
use super::condense::{Condensation, Item};
use super::inertia::Inertia;
use super::lanes::subtract;
use super::numeric::Factors;
use super::pivot::Rules;
use super::plan::Plan;
use super::solve::solve;

/// Greatest response of a state against the greatest one in the stage of an input. Beyond, what is left of R are errors of rounding;
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
    parts: Condensation,
    blocks: BlockLu,
    /// S and H S + Kᵀ by rows, one row for each state.
    sensitivities: Vec<f64>,
    weighted: Vec<f64>,
    /// Right-hand sides of one stage by columns.
    columns: Vec<f64>,
    /// R by rows, and its lower triangle as entries.
    reduced: Vec<f64>,
    plan: Plan,
    entries: Vec<f64>,
    factors: Factors,
    work: Vec<f64>,
    /// States, gradients by states, and the rest.
    states: Vec<f64>,
    gradient: Vec<f64>,
    rest: Vec<f64>,
}

impl Condensed {
    pub(super) fn new(parts: Condensation) -> Self {
        let (n, m) = (parts.states.len(), parts.rest.len());
        let (mut rows, mut cols) = (Vec::new(), Vec::new());
        for row in 0..m as u32 {
            rows.extend((0..=row).map(|_| row));
            cols.extend(0..=row);
        }
        let largest = parts.stages.iter().map(ExactSizeIterator::len).max();
        Self {
            blocks: BlockLu::new(&parts.stages, m),
            sensitivities: vec![0.0; n * m],
            weighted: vec![0.0; n * m],
            columns: vec![0.0; largest.unwrap_or(0) * m.max(1)],
            reduced: vec![0.0; m * m],
            entries: Vec::with_capacity(rows.len()),
            plan: Plan::new(m, &rows, &cols, None),
            factors: Factors::default(),
            work: Vec::new(),
            states: vec![0.0; n],
            gradient: vec![0.0; n],
            rest: vec![0.0; m],
            parts,
        }
    }

    /// Factors the matrix with these entries; `None` where the equations hold more than they may, or responses grow along the horizon.
    pub(super) fn factor(&mut self, entries: &[f64]) -> Option<Inertia> {
        let mut zeros = self.parts.zeros.iter();
        if zeros.any(|&entry| entries[entry as usize] != 0.0) {
            return None;
        }
        self.factor_blocks(entries);
        self.find_sensitivities(entries);
        if self.is_growing() {
            return None;
        }
        self.reduce(entries);
        let m = self.parts.rest.len();
        self.entries.clear();
        for row in 0..m {
            self.entries
                .extend_from_slice(&self.reduced[row * m..][..=row]);
        }
        let is_finite = self.entries.iter().all(|entry| entry.is_finite());
        let outcome = is_finite.then(|| {
            self.factors
                .factor(&self.plan, &self.entries, RULES, usize::MAX)
        })??;
        Some(Inertia {
            negative: outcome.inertia.negative + self.parts.states.len(),
            zero: outcome.inertia.zero,
        })
    }

    fn factor_blocks(&mut self, entries: &[f64]) {
        self.blocks.clear();
        for (k, items) in self.parts.diagonal.iter().enumerate() {
            for item in items {
                let value = entries[item.entry as usize];
                self.blocks
                    .add(k, item.row as usize, item.column as usize, value);
            }
            self.blocks.factor(k);
        }
    }

    fn find_sensitivities(&mut self, entries: &[f64]) {
        let (parts, m) = (&self.parts, self.parts.rest.len());
        for (k, range) in parts.stages.iter().enumerate() {
            let (n, reach) = (range.len(), parts.reach[k]);
            let (done, own) = self.sensitivities.split_at_mut(range.start * m);
            let own = &mut own[..n * m];
            own.fill(0.0);
            for item in &parts.inputs[k] {
                let row = item.row as usize - range.start;
                own[row * m + item.column as usize] -= entries[item.entry as usize];
            }
            Arch::new().dispatch(Product {
                items: &parts.below[k],
                entries,
                from: done,
                to: own,
                first: range.start,
                width: m,
                count: reach,
            });
            let columns = &mut self.columns[..n * reach];
            for (i, row) in own.chunks_exact(m).enumerate() {
                for (j, value) in row[..reach].iter().enumerate() {
                    columns[i + j * n] = *value;
                }
            }
            if reach > 0 {
                self.blocks.solve(k, columns, false);
            }
            for (i, row) in own.chunks_exact_mut(m).enumerate() {
                for (j, value) in row[..reach].iter_mut().enumerate() {
                    *value = columns[i + j * n];
                }
            }
        }
    }

    /// Whether later responses to inputs are out of proportion to immediate ones, or no numbers.
    fn is_growing(&self) -> bool {
        let (mut immediate, mut greatest, mut before): (f64, f64, usize) = (0.0, 0.0, 0);
        let m = self.parts.rest.len().max(1);
        for (range, &reach) in self.parts.stages.iter().zip(&self.parts.reach) {
            for row in self.sensitivities[range.start * m..range.end * m].chunks_exact(m) {
                let most = |list: &[f64]| list.iter().fold(0.0, |most: f64, s| most.max(s.abs()));
                immediate = immediate.max(most(&row[before..reach]));
                greatest = greatest.max(most(&row[..reach]));
            }
            before = reach;
        }
        greatest > GROWTH * immediate || !greatest.is_finite()
    }

    fn reduce(&mut self, entries: &[f64]) {
        let (parts, m) = (&self.parts, self.parts.rest.len());
        let product = |items, to: &mut [f64], from: &[f64]| {
            Arch::new().dispatch(Product {
                items,
                entries,
                from,
                to,
                first: 0,
                width: m,
                count: m,
            });
        };
        // −H S, and −K S as part of −R.
        self.weighted.fill(0.0);
        product(&parts.curvature, &mut self.weighted, &self.sensitivities);
        Arch::new().dispatch(Transposed {
            items: &parts.curvature,
            entries,
            from: &self.sensitivities,
            to: &mut self.weighted,
            width: m,
        });
        self.reduced.fill(0.0);
        product(&parts.coupling, &mut self.reduced, &self.sensitivities);
        for item in &parts.coupling {
            let at = item.column as usize * m + item.row as usize;
            self.weighted[at] -= entries[item.entry as usize];
        }
        let mut reduced = MatMut::from_row_major_slice_mut(&mut self.reduced, m, m);
        for (range, &reach) in parts.stages.iter().zip(&parts.reach) {
            let rows = range.start * m..range.end * m;
            let (n, own) = (range.len(), &self.sensitivities[rows.clone()]);
            let own = MatRef::from_row_major_slice(own, n, m).subcols(0, reach);
            let weighted = MatRef::from_row_major_slice(&self.weighted[rows], n, m);
            let target = reduced.as_mut().subrows_mut(0, reach);
            matmul(target, Accum::Add, own.transpose(), weighted, 1.0, Par::Seq);
        }
        self.reduced.iter_mut().for_each(|entry| *entry = -*entry);
        for item in &parts.corner {
            let (row, column) = (item.row as usize, item.column as usize);
            self.reduced[row * m + column] += entries[item.entry as usize];
        }
    }

    /// Replaces a right-hand side by the solution.
    pub(super) fn solve(&mut self, entries: &[f64], x: &mut [f64]) {
        let Self {
            parts,
            blocks,
            states,
            gradient,
            rest,
            ..
        } = self;
        let value = |item: &Item| entries[item.entry as usize];
        // s₀.
        for (k, range) in parts.stages.iter().enumerate() {
            for i in range.clone() {
                states[i] = x[parts.equations[i] as usize];
            }
            for item in &parts.below[k] {
                states[item.row as usize] -= value(item) * states[item.column as usize];
            }
            blocks.solve(k, &mut states[range.clone()], false);
        }
        // r_w − K s₀ + Sᵀ (r_s − H s₀).
        gather(x, &parts.rest, rest);
        for item in &parts.coupling {
            rest[item.row as usize] -= value(item) * states[item.column as usize];
        }
        gather(x, &parts.states, gradient);
        subtract_symmetric(&parts.curvature, entries, states, gradient);
        let m = rest.len();
        for (row, gradient) in self.sensitivities.chunks_exact(m.max(1)).zip(&*gradient) {
            for (rest, sensitivity) in rest.iter_mut().zip(row) {
                *rest += sensitivity * gradient;
            }
        }
        solve(&self.factors, rest, &mut self.work);
        for (row, state) in self.sensitivities.chunks_exact(m.max(1)).zip(&mut *states) {
            *state += row.iter().zip(&*rest).map(|(s, w)| s * w).sum::<f64>();
        }
        // Aᵀ y = r_s − H s − Kᵀ w.
        gather(x, &parts.states, gradient);
        subtract_symmetric(&parts.curvature, entries, states, gradient);
        for item in &parts.coupling {
            gradient[item.column as usize] -= value(item) * rest[item.row as usize];
        }
        for (k, range) in parts.stages.iter().enumerate().rev() {
            blocks.solve(k, &mut gradient[range.clone()], true);
            for item in &parts.below[k] {
                gradient[item.column as usize] -= value(item) * gradient[item.row as usize];
            }
        }
        scatter(states, &parts.states, x);
        scatter(gradient, &parts.equations, x);
        scatter(rest, &parts.rest, x);
    }
}

fn gather(x: &[f64], unknowns: &[u32], to: &mut [f64]) {
    for (value, &i) in to.iter_mut().zip(unknowns) {
        *value = x[i as usize];
    }
}

fn scatter(from: &[f64], unknowns: &[u32], x: &mut [f64]) {
    for (value, &i) in from.iter().zip(unknowns) {
        x[i as usize] = *value;
    }
}

/// `y ← y − H x`, each entry of H listed once.
fn subtract_symmetric(items: &[Item], entries: &[f64], x: &[f64], y: &mut [f64]) {
    for item in items {
        let (row, column) = (item.row as usize, item.column as usize);
        let value = entries[item.entry as usize];
        y[row] -= value * x[column];
        if row != column {
            y[column] -= value * x[row];
        }
    }
}

/// `to ← to − B from` for a sparse B: rows of `width` numbers, of which `count` matter; rows of `to` begin with `first`.
struct Product<'a> {
    items: &'a [Item],
    entries: &'a [f64],
    from: &'a [f64],
    to: &'a mut [f64],
    first: usize,
    width: usize,
    count: usize,
}

impl WithSimd for Product<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, unit: S) {
        for item in self.items {
            let value = self.entries[item.entry as usize];
            let to = (item.row as usize - self.first) * self.width;
            let from = &self.from[item.column as usize * self.width..][..self.count];
            subtract(unit, &mut self.to[to..to + self.count], from, value);
        }
    }
}

/// `to ← to − Bᵀ from` for the entries of a sparse B that are not on its diagonal.
struct Transposed<'a> {
    items: &'a [Item],
    entries: &'a [f64],
    from: &'a [f64],
    to: &'a mut [f64],
    width: usize,
}

impl WithSimd for Transposed<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, unit: S) {
        for item in self.items.iter().filter(|item| item.row != item.column) {
            let value = self.entries[item.entry as usize];
            let from = &self.from[item.row as usize * self.width..][..self.width];
            let to = &mut self.to[item.column as usize * self.width..][..self.width];
            subtract(unit, to, from, value);
        }
    }
}
