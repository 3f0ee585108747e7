//! A program among those that are joined, and work on all of them.

use std::ops::Range;
use std::sync::Arc;

use crate::math::join_if;
use crate::nlp::Nlp;

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
