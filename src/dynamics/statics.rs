//! Rest: the same action on an interval whose two instants are one.
//!
//! With q_k = q_{k+1} = q inertia and viscosity vanish from the rows by themselves, and the sum of both rows is
//! −h Pᵀ∇V − h₀ Gᵀλ; the tangent is the sum of the four blocks. Potentials keep the rows of Gauss's law.

use crate::dynamics::EquilibriumError;
use crate::dynamics::tangent::{Entries, Tangent};
use crate::functional::Level;
use crate::ipopt::interrupt;
use crate::math::Vector;
use crate::model::Model;
use crate::reduction::{Instant, Interval, Scratch};
use crate::sparse::{Singular, Symmetry};

/// Limit of Newton iterations for one load.
const ITERATIONS: usize = 30;
/// Convergence of the Newton update, relative to angles of one radian and the length of the system.
const UPDATE: f64 = 1e-11;

/// A state of rest: coordinates and multipliers, then potentials.
pub(super) type State = Vec<f64>;

/// How Newton's method ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Outcome {
    Converged,
    Failed,
}

/// Rows and tangent of rest.
#[derive(Debug)]
pub(super) struct Statics<'m> {
    pub(super) model: &'m Model,
    a: Instant,
    b: Instant,
    scratch: Scratch,
    values: Vec<f64>,
    scalars: Vec<f64>,
    tangent: Tangent,
    /// The potentials' own block.
    electric: Option<Tangent>,
    /// Rows, then the Newton update.
    pub(super) residual: Vec<f64>,
    scales: Vec<f64>,
    pub(super) iterations: usize,
}

impl<'m> Statics<'m> {
    pub(super) fn new(model: &'m Model) -> Self {
        let motion = &model.action.motion;
        let layout = model.action.layout();
        let (n, m) = (motion.coordinates, motion.unknowns());
        let mut entries = Entries::default();
        for (slot, &entry) in layout.same.entries().iter().enumerate() {
            entries.add(layout.same_at(0) + slot, entry);
            entries.add_to(layout.same_at(1) + slot, slot);
        }
        for (slot, &(row, col)) in layout.cross.entries().iter().enumerate() {
            let same = layout.same.find(row, col);
            let same = same.expect("what couples neighbouring instants couples within one");
            entries.add_to(layout.lower_at(0) + slot, same);
            entries.add_to(layout.upper_at(0) + slot, same);
        }
        entries.add_potentials(model, &[[0, 0], [1, 1]]);
        let size = m + model.potentials;
        let electric = (model.potentials > 0).then(|| {
            let mut entries = Entries::default();
            entries.add_potentials(model, &[]);
            entries.tangent_from(m, model.potentials, Symmetry::Symmetric, None)
        });
        let length = model.length();
        let scale = |i: usize| match i {
            i if i < n && !model.is_length(i) => 1.0,
            i if i >= n && i < m => f64::INFINITY,
            _ => length,
        };
        Self {
            model,
            a: motion.instant(),
            b: motion.instant(),
            scratch: model.action.scratch(Level::Hessian),
            values: vec![0.0; layout.values(1)],
            scalars: vec![0.0; layout.interval_scalars],
            tangent: entries.tangent(size, Symmetry::Symmetric, None),
            electric,
            residual: vec![0.0; size],
            scales: (0..size).map(scale).collect(),
            iterations: 0,
        }
    }

    /// Rows and second derivatives at a state under voltages.
    pub(super) fn evaluate(&mut self, state: &[f64], voltages: &[f64]) {
        let action = &self.model.action;
        let m = action.motion.unknowns();
        let driven = voltages.len();
        let Self {
            a,
            b,
            scratch,
            values,
            scalars,
            residual,
            ..
        } = self;
        scalars[..driven].copy_from_slice(voltages);
        scalars[driven..].copy_from_slice(&state[m..]);
        values.fill(0.0);
        for instant in [&mut *a, &mut *b] {
            instant.z.copy_from_slice(&state[..m]);
            action.motion.place(instant);
            instant.forces.fill(Vector::zeros());
        }
        let interval = Interval::given(scalars, self.model.multiplier_time);
        action.evaluate_interval(Level::Hessian, [a, b], &interval, scratch);
        action.pull_back_interval(Level::Hessian, [a, b], &interval, 0, scratch, values);
        for (force, other) in a.forces.iter_mut().zip(&b.forces) {
            *force += other;
        }
        action.evaluate_instant(Level::Hessian, a, &[], scratch);
        action.pull_back_instant(Level::Hessian, a, 0, scratch, values);
        residual.fill(0.0);
        action.rows(a, scratch, &mut residual[..m]);
        residual[m..].copy_from_slice(&scratch.interval.plain.rows[driven..]);
    }

    /// Factorises the tangent of the state evaluated last.
    pub(super) fn factor(&mut self) -> Result<(), Singular> {
        self.tangent.factor(&self.values)
    }

    /// Solves with the last factorisation, in place.
    pub(super) fn solve(&mut self, rhs: &mut [f64]) {
        self.tangent.solve(rhs);
    }

    /// Adds the derivative of the rows along a change of the voltages, at the state evaluated last.
    pub(super) fn add_load(&self, change: &[f64], rows: &mut [f64]) {
        let layout = self.model.action.layout();
        let (m, driven) = (self.model.action.motion.unknowns(), change.len());
        for side in 0..2 {
            for (slot, &(i, s)) in layout.mixed.entries().iter().enumerate() {
                if s < driven {
                    rows[i] += self.values[layout.mixed_at(0, side) + slot] * change[s];
                }
            }
        }
        for (slot, &(s, t)) in layout.scalars.entries().iter().enumerate() {
            if s >= driven && t < driven {
                rows[m + s - driven] += self.values[layout.scalars_at(0) + slot] * change[t];
            }
        }
    }

    /// Size of an update, relative to angles of one radian and the length of the system.
    pub(super) fn size(&self, update: &[f64]) -> f64 {
        let relative = |(u, s): (&f64, &f64)| (u / s).abs();
        let worst = |a: f64, b: f64| if b.is_nan() { b } else { a.max(b) };
        update
            .iter()
            .zip(&self.scales)
            .map(relative)
            .fold(0.0, worst)
    }

    /// Newton at one load.
    pub(super) fn newton(
        &mut self,
        state: &mut State,
        voltages: &[f64],
    ) -> Result<Outcome, EquilibriumError> {
        let mut last = f64::INFINITY;
        for _ in 0..ITERATIONS {
            if let Some(status) = interrupt::stop() {
                return Err(EquilibriumError::Stopped(status));
            }
            self.iterations += 1;
            self.evaluate(state, voltages);
            if self.residual.iter().any(|r| !r.is_finite()) {
                return Ok(Outcome::Failed);
            }
            if let Err(singular) = self.factor() {
                let unknowns = self.model.action.motion.unknowns();
                return Err(EquilibriumError::Singular {
                    name: self.model.unknown_name(singular.column),
                    redundant: self.model.redundant_constraints(&state[..unknowns]),
                });
            }
            let mut update = std::mem::take(&mut self.residual);
            self.solve(&mut update);
            let size = self.size(&update);
            // A long update leaves the region in which the tangent says anything.
            let damping = if size > 0.5 { 0.5 / size } else { 1.0 };
            for (value, update) in state.iter_mut().zip(&update) {
                *value -= damping * update;
            }
            self.residual = update;
            if size < UPDATE || (size < 1e-8 && size >= 0.5 * last) {
                return Ok(Outcome::Converged);
            }
            last = size;
        }
        Ok(Outcome::Failed)
    }

    /// Number of directions in which the potential energy of the state evaluated and factorised last falls, potentials
    /// following; `None` where the factorisation does not tell.
    ///
    /// The tangent is −h S with S the saddle of coordinates, multipliers and potentials: each multiplier has one negative
    /// eigenvalue of S, potentials have those of their own block, what remains belongs to the coordinates.
    pub(super) fn unstable(&mut self) -> Option<usize> {
        let positive = self.tangent.negative_pivots()?;
        let negative = self.residual.len() - positive;
        let electric = match &mut self.electric {
            Some(tangent) => {
                tangent.factor(&self.values).ok()?;
                self.model.potentials - tangent.negative_pivots()?
            }
            None => 0,
        };
        negative.checked_sub(self.model.action.motion.multipliers + electric)
    }

    /// Weights of the squares of a state's entries in the length of a path.
    pub(super) fn weights(&self) -> Vec<f64> {
        let count = self.scales.len() as f64;
        let weight = |scale: &f64| 1.0 / (scale * scale * count);
        self.scales.iter().map(weight).collect()
    }

    /// Entries of the tangent factorised last.
    pub(super) fn entries(&self) -> impl Iterator<Item = ((usize, usize), f64)> + '_ {
        self.tangent.entries()
    }
}
