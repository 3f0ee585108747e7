//! The square system of one Newton iteration: the derivatives of the action that it holds, and its factorisation.
//!
//! Unknowns are those of a step (see [`Variables`](crate::model::Variables)).

use crate::coordinates::StepPattern;
use crate::dynamics::trajectory::TangentState;
use crate::math::{IsOver, Stopped, compact_index};
use crate::model::Model;
use crate::sparse::{Backend, Direct, Precision, Singular, Symmetry};
use std::collections::HashSet;

/// Places in the values of the action, summed into the entries of a matrix.
#[derive(Debug)]
pub(super) struct Tangent {
    /// (place in the values, entry of the matrix).
    gather: Vec<(u32, u32)>,
    entries: Vec<(u32, u32)>,
    /// (entry of the matrix, its constant value).
    constants: Vec<(u32, f64)>,
    matrix: Vec<f64>,
    solver: Direct,
    /// True if the symmetric part ½(A + Aᵀ) is factorised in place of the matrix A.
    is_approximate: bool,
}

fn pair(entry: (usize, usize)) -> (u32, u32) {
    (compact_index(entry.0), compact_index(entry.1))
}

fn uncounted(entry: (u32, u32)) -> (usize, usize) {
    (entry.0 as usize, entry.1 as usize)
}

/// The entry of the lower triangle that is this one or its transpose.
fn lower(entry: (u32, u32)) -> (usize, usize) {
    let (i, j) = uncounted(entry);
    (i.max(j), i.min(j))
}

/// Lists entries before the factorisation is prepared.
#[derive(Clone, Debug, Default)]
pub(super) struct EntryList {
    entries: Vec<(u32, u32)>,
    gather: Vec<(u32, u32)>,
    constants: Vec<(u32, f64)>,
}

impl EntryList {
    /// A new entry of the matrix that takes the value at a place.
    pub(super) fn add(&mut self, place: usize, entry: (usize, usize)) {
        self.add_to(place, self.entries.len());
        self.entries.push(pair(entry));
    }

    /// Adds the value at a place to an entry that exists.
    pub(super) fn add_to(&mut self, place: usize, entry: usize) {
        self.gather.push(pair((place, entry)));
    }

    /// Scalars with an equation against the coordinates of the rows (instant `sides[0]`) and of the columns (instant `sides[1]`) of
    /// the interval 0, and against each other.
    pub(super) fn add_scalars(&mut self, model: &Model, sides: &[[usize; 2]]) {
        let layout: &StepPattern = model.action.layout();
        let place = |s: usize| model.variables.place(s);
        for (slot, (i, s)) in layout.mixed.entries().enumerate() {
            let Some(s) = place(s) else {
                continue;
            };
            for &[row, col] in sides {
                self.add(layout.mixed_at(0, row) + slot, (i, s));
                self.add(layout.mixed_at(0, col) + slot, (s, i));
            }
        }
        for (slot, (s, t)) in layout.scalars.entries().enumerate() {
            if let (Some(s), Some(t)) = (place(s), place(t)) {
                self.add(layout.scalars_at(0) + slot, (s, t));
                if s != t {
                    self.add(layout.scalars_at(0) + slot, (t, s));
                }
            }
        }
    }

    /// Holds unknowns at their values: of their rows and columns only the diagonal remains, with this pivot.
    pub(super) fn hold(&mut self, unknowns: &[usize], pivot: f64) {
        if unknowns.is_empty() {
            return;
        }
        let entries = &self.entries;
        let held: HashSet<usize> = unknowns.iter().copied().collect();
        let is_held = |i: u32| held.contains(&(i as usize));
        self.gather.retain(|(_, entry)| {
            let (row, col) = entries[*entry as usize];
            !is_held(row) && !is_held(col)
        });
        for &unknown in unknowns {
            self.constants
                .push((compact_index(self.entries.len()), pivot));
            self.entries.push(pair((unknown, unknown)));
        }
    }

    /// Prepares the factorisation of the unknowns from `first` on.
    pub(super) fn tangent_from(
        mut self,
        first: usize,
        size: usize,
        symmetry: Symmetry,
        backend: Option<Backend>,
    ) -> Tangent {
        for entry in &mut self.entries {
            let (row, col) = uncounted(*entry);
            *entry = pair((row - first, col - first));
        }
        let entries = self.entries.iter().copied().map(uncounted);
        let solver = Direct::with_entries(size, entries, symmetry, backend);
        self.tangent_by(solver, false)
    }

    /// Prepares a factorisation for an iteration that corrects its approximation: of the symmetric part where the matrix has
    /// no symmetry, and in single precision where it is large.
    pub(super) fn corrected_tangent(self, model: &Model, symmetry: Symmetry) -> Tangent {
        let is_approximate = symmetry == Symmetry::Unsymmetric;
        let places = model.unknown_places();
        let kept = |entry| match is_approximate {
            true => lower(entry),
            false => uncounted(entry),
        };
        let entries = self.entries.iter().copied().map(kept);
        let solver = Direct::for_iteration(places.len(), entries, &places);
        self.tangent_by(solver, is_approximate)
    }

    fn tangent_by(mut self, solver: Direct, is_approximate: bool) -> Tangent {
        self.entries.shrink_to_fit();
        self.gather.shrink_to_fit();
        Tangent {
            matrix: vec![0.0; self.entries.len()],
            solver,
            gather: self.gather,
            entries: self.entries,
            constants: self.constants,
            is_approximate,
        }
    }

    /// Prepares the factorisation of the symmetric part.
    pub(super) fn symmetric_part(self, size: usize) -> Tangent {
        let entries = self.entries.iter().copied().map(lower);
        let solver = Direct::with_entries(size, entries, Symmetry::Symmetric, None);
        self.tangent_by(solver, true)
    }

    /// Prepares the factorisation.
    pub(super) fn tangent(
        self,
        size: usize,
        symmetry: Symmetry,
        backend: Option<Backend>,
    ) -> Tangent {
        self.tangent_from(0, size, symmetry, backend)
    }
}

impl Tangent {
    /// The method that factorises.
    pub(super) fn name(&self) -> String {
        let method = self.solver.method();
        match self.is_approximate {
            true => format!("{method} of the symmetric part"),
            false => method.to_owned(),
        }
    }

    /// Factorises the matrix of these values.
    pub(super) fn factor(&mut self, values: &[f64]) -> Result<(), Singular> {
        let done = self.factor_unless(values, &|| false);
        done.expect("it is never time to stop")
    }

    /// The same, unless it is time to stop before it is done.
    pub(super) fn factor_unless(
        &mut self,
        values: &[f64],
        is_over: IsOver<'_>,
    ) -> Result<Result<(), Singular>, Stopped> {
        self.matrix.fill(0.0);
        for &(place, entry) in &self.gather {
            self.matrix[entry as usize] += values[place as usize];
        }
        for &(entry, value) in &self.constants {
            self.matrix[entry as usize] = value;
        }
        if self.is_approximate {
            for (value, (row, col)) in self.matrix.iter_mut().zip(&self.entries) {
                *value *= if row == col { 1.0 } else { 0.5 };
            }
        }
        self.solver.factor_unless(&self.matrix, is_over)
    }

    /// Returns true if the factors are those of the symmetric part of a matrix without symmetry, or in single precision.
    pub(super) fn is_approximate(&self) -> bool {
        self.is_approximate || self.solver.precision() == Precision::Single
    }

    /// S⁻¹ (A − S) u where the symmetric part S of the matrix A is factorised: an update u leaves so much.
    pub(super) fn left_out(&mut self, update: &[f64]) -> Option<Vec<f64>> {
        self.is_approximate.then_some(())?;
        let mut rest = vec![0.0; update.len()];
        for (&(row, col), value) in self.entries.iter().zip(&self.matrix) {
            if row != col {
                // The matrix holds halves next to the diagonal.
                rest[row as usize] += value * update[col as usize];
                rest[col as usize] -= value * update[row as usize];
            }
        }
        self.solver.solve_roughly(&mut rest);
        Some(rest)
    }

    /// Factorises in double precision from now on; returns true if it did not before.
    pub(super) fn make_double(&mut self) -> bool {
        self.solver.make_double()
    }

    /// Factorises the whole matrix, in double precision, from now on; returns true if it did not before.
    pub(super) fn make_exact(&mut self) -> bool {
        if !std::mem::take(&mut self.is_approximate) {
            return false;
        }
        let entries = self.entries.iter().copied().map(uncounted);
        self.solver =
            Direct::with_entries(self.solver.size(), entries, Symmetry::Unsymmetric, None);
        true
    }

    /// Writes how it is factorised, and the matrix where its factors are used again.
    pub(super) fn keep(&self, with_matrix: bool, to: &mut TangentState) {
        to.is_approximate = self.is_approximate;
        to.method = self.solver.state();
        to.matrix.clear();
        if with_matrix {
            to.matrix.extend_from_slice(&self.matrix);
        }
    }

    /// Factorises as it was done before; returns true if that is possible.
    pub(super) fn take(&mut self, from: &TangentState) -> bool {
        if self.is_approximate && !from.is_approximate {
            self.make_exact();
        }
        if self.is_approximate != from.is_approximate || !self.solver.take(&from.method) {
            return false;
        }
        if from.step.is_none() {
            return true;
        }
        if from.matrix.len() != self.matrix.len() {
            return false;
        }
        self.matrix.copy_from_slice(&from.matrix);
        self.solver.factor_again(&self.matrix).is_ok()
    }

    /// Number of negative pivots of the last factorisation, where it gives it.
    pub(super) fn negative_pivots(&self) -> Option<usize> {
        self.solver.negative_pivots()
    }

    /// Entries of the matrix factorised last.
    pub(super) fn entries(&self) -> impl Iterator<Item = ((usize, usize), f64)> + '_ {
        let entries = self.entries.iter().copied().map(uncounted);
        entries.zip(self.matrix.iter().copied())
    }

    /// Solves with the last factorisation in place, without a look at the residual.
    pub(super) fn solve_roughly(&mut self, rhs: &mut [f64]) {
        self.solver.solve_roughly(rhs);
    }

    /// Solves with the last factorisation, in place.
    pub(super) fn solve(&mut self, rhs: &mut [f64]) {
        self.solver.solve(rhs);
    }
}
