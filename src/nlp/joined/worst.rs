//! The greatest of the objectives f of programs in place of their sum, by its epigraph:
//!
//! ```text
//! minimise t   subject to   f − t ≤ 0 of each program.
//! ```
//!
//! The variable is s t, with the factor s that brings objectives near 1. The multipliers of these rows are the weights with which the
//! objectives count at the optimum: s times their sum is 1, and those of programs below the greatest one are zero.

use crate::math::join_if;
use crate::nlp::Nlp;
use std::ops::Range;
use std::sync::Arc;

/// Part of the greatest objective by which the first bound lies above it.
const ABOVE: f64 = 0.1;

/// The bound of all objectives.
pub(super) struct Worst {
    /// Its variable, the last one.
    pub(super) column: usize,
    /// Row of the first program, behind those of all of them.
    pub(super) first_row: usize,
    /// s.
    pub(super) scale: f64,
}

impl Worst {
    /// t.
    pub(super) fn objective(&self, x: &[f64]) -> f64 {
        x[self.column] / self.scale
    }

    /// ∇t.
    pub(super) fn gradient(&self, grad: &mut [f64]) {
        grad.fill(0.0);
        grad[self.column] = 1.0 / self.scale;
    }

    /// Factor of the objective of a program in the Lagrangian.
    pub(super) fn weight(&self, number: usize, costates: &[f64]) -> f64 {
        self.scale * costates[self.first_row + number]
    }

    /// Puts the bound above all objectives into a point of the variables of programs, and shares it out among multipliers.
    pub(super) fn complete<N: Nlp + Send>(
        &self,
        parts: &mut [Part<N>],
        x: &mut [f64],
        multipliers: Option<&mut Vec<f64>>,
    ) {
        each(parts, &mut [], &|_| 0, &|part, _| part.evaluate(x));
        let objectives = parts.iter().map(|part| self.scale * part.objective);
        let greatest = objectives.fold(f64::NEG_INFINITY, f64::max);
        x[self.column] = greatest + ABOVE * greatest.abs();
        if let Some(multipliers) = multipliers {
            let share = 1.0 / (self.scale * parts.len() as f64);
            multipliers.resize(self.first_row + parts.len(), share);
        }
    }

    /// The rows s f − s t.
    pub(super) fn rows<N: Nlp + Send>(&self, parts: &mut [Part<N>], x: &[f64], rows: &mut [f64]) {
        each(parts, &mut [], &|_| 0, &|part, _| part.evaluate(x));
        for (row, part) in rows.iter_mut().zip(parts) {
            *row = self.scale * part.objective - x[self.column];
        }
    }

    /// Their gradients.
    pub(super) fn entries<N: Nlp + Send>(
        &self,
        parts: &mut [Part<N>],
        x: &[f64],
        values: &mut [f64],
    ) {
        each(parts, &mut [], &|_| 0, &|part, _| part.differentiate(x));
        let of_rows = parts.iter().flat_map(|part| {
            let columns = part.columns.iter().zip(&part.gradient);
            let own = columns.map(|((_, factor), slope)| self.scale * factor * slope);
            own.chain([-1.0])
        });
        for (value, entry) in values.iter_mut().zip(of_rows) {
            *value = entry;
        }
    }
}

/// A program and its part of the whole.
pub(super) struct Part<N> {
    pub(super) program: N,
    pub(super) name: String,
    /// Variable of the whole that each of its variables is, and the factor by which its value is larger.
    pub(super) columns: Arc<[(usize, f64)]>,
    pub(super) rows: Range<usize>,
    /// Numbers of entries of Jacobian and Hessian.
    pub(super) entries: [usize; 2],
    /// Entries of Jacobian and Hessian whose value is larger in the whole, and the factors.
    pub(super) scaled: [Vec<(usize, f64)>; 2],
    pub(super) x: Vec<f64>,
    pub(super) objective: f64,
    pub(super) gradient: Vec<f64>,
    /// Factor of its objective in the Lagrangian.
    pub(super) weight: f64,
}

impl<N: Nlp> Part<N> {
    /// Its objective at a point.
    pub(super) fn evaluate(&mut self, x: &[f64]) {
        self.read(x);
        self.objective = self.program.objective(&self.x);
    }

    /// The gradient of its objective at a point.
    pub(super) fn differentiate(&mut self, x: &[f64]) {
        self.read(x);
        self.program.gradient(&self.x, &mut self.gradient);
    }
}

impl<N> Part<N> {
    /// Reads its variables of a point.
    pub(super) fn read(&mut self, x: &[f64]) {
        for (value, &(from, factor)) in self.x.iter_mut().zip(self.columns.iter()) {
            *value = factor * x[from];
        }
    }

    /// Scales entries of Jacobian or Hessian as the whole reads them.
    pub(super) fn scale(&self, kind: usize, values: &mut [f64]) {
        for &(entry, factor) in &self.scaled[kind] {
            values[entry] *= factor;
        }
    }

    pub(super) fn named(&self, name: String) -> String {
        match self.name.is_empty() {
            true => name,
            false => format!("{}: {name}", self.name),
        }
    }
}

/// Does work on each part and its share of some values, the halves of a list at once: what is computed does not depend on threads.
pub(super) fn each<N: Send>(
    parts: &mut [Part<N>],
    values: &mut [f64],
    count: &(dyn Fn(&Part<N>) -> usize + Sync),
    work: &(dyn Fn(&mut Part<N>, &mut [f64]) + Sync),
) {
    match parts {
        [part] => work(part, values),
        _ => {
            let (first, second) = parts.split_at_mut(parts.len() / 2);
            let (a, b) = values.split_at_mut(first.iter().map(count).sum());
            let halves = [(first, a), (second, b)]
                .map(|(parts, values)| move || each(parts, values, count, work));
            let [first, second] = halves;
            join_if(true, first, second);
        }
    }
}
