//! The greatest of the objectives f of programs in place of their sum, by its epigraph:
//!
//! ```text
//! minimise t   subject to   f − t ≤ 0 of each program.
//! ```
//!
//! The variable is s t, with the factor s that brings objectives near 1. The multipliers of these rows are the weights with which the
//! objectives count at the optimum: s times their sum is 1, and those of programs below the greatest one are zero.

use crate::nlp::Nlp;
use crate::nlp::joined::part::{Part, each};

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
