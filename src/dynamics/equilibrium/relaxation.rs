//! Overdamped motion from a state to rest, all loads acting: B q̇ = f(q), with the forces f and B of the scales of the coordinates.
//!
//! Implicit Euler steps with one Newton iteration each, (B/Δt − ∂f/∂q) Δq = f, as long as Δt admits: no motion grows by the matrix, and the
//! step is short (pseudo-transient continuation). Forces need no potential: loads may follow what they act on.

use crate::dynamics::equilibrium::rest_state::RestState;
use crate::dynamics::equilibrium::statics::{ITERATIONS, Statics};
use crate::dynamics::singular_configurations::{reversed, shortest};
use crate::functional::{Order, Sample, TermKind};
use crate::math::Vector;
use crate::stop;

/// Limit of steps.
const STEPS: usize = 1000;
/// Longest step, in radians and lengths of the system.
const LONGEST: f64 = 0.1;
/// Size of the last step, without damping.
const UPDATE: f64 = 1e-9;
/// Part of the damping and of the longest step at which the damping changes.
const CUT: f64 = 0.25;
/// Damping below this part of the largest stiffness is none, and beyond its inverse nothing moves. Bent blocks of square sections are so soft
/// when they turn about their axis.
const NONE: f64 = 1e-13;
/// Muscles shorter than this part of their length have collapsed.
const COLLAPSED: f64 = 0.03;

/// The state at which the overdamped motion from another comes to rest; `None` where it does not.
pub(super) fn relax(
    statics: &mut Statics<'_>,
    from: &RestState,
    voltages: &[f64],
) -> Option<RestState> {
    statics.weight = 1.0;
    let model = statics.model;
    let mut state = from.clone();
    statics.settle(&mut state, voltages)?;
    statics.evaluate(&state, voltages);
    let mut placed = statics.a.clone();
    let largest = statics.largest_stiffness();
    let mut damping = largest;
    for _ in 0..STEPS {
        if stop::reason().is_some() || damping * NONE > largest {
            return None;
        }
        statics.iterations += 1;
        let is_free = damping < NONE * largest;
        let is_factored = match is_free {
            true => statics.factor().is_ok(),
            false => statics.factor_with(damping).is_ok(),
        };
        if !is_factored || statics.unstable() != Some(0) {
            damping = f64::max(damping, NONE * largest) / CUT;
            continue;
        }
        let mut update = statics.residual.clone();
        statics.solve(&mut update);
        let size = statics.size(&update);
        if is_free && size < UPDATE {
            return Some(state);
        }
        let is_short = size < LONGEST;
        let trial = statics.moved(&state, -1.0, &update);
        if is_short {
            statics.evaluate(&trial, voltages);
        }
        let is_there = statics.residual.iter().all(|row| row.is_finite());
        if !is_short || !is_there || reversed(model, &placed, &statics.a).is_some() {
            damping = f64::max(damping, NONE * largest) / CUT;
            statics.evaluate(&state, voltages);
            continue;
        }
        placed.clone_from(&statics.a);
        if shortest(model, &placed).is_some_and(|(_, s)| s < COLLAPSED) {
            return None;
        }
        if size < CUT * LONGEST {
            damping *= CUT;
        }
        state = trial;
    }
    None
}

/// Size of the last correction, relative to angles of one radian and the length of the system.
const LEAST_UPDATE: f64 = 1e-12;

impl Statics<'_> {
    /// Potential energy in N mm of a state under voltages, all weights acting; the instant stays placed there.
    pub(super) fn energy(&mut self, state: &RestState, voltages: &[f64]) -> f64 {
        let action = &self.model.action;
        let m = action.map.unknowns();
        let variables = &self.model.variables;
        self.scalars[variables.inputs()].copy_from_slice(voltages);
        self.scalars[variables.algebraic()].copy_from_slice(&state[m..]);
        self.place(state);
        let interval = Sample::of_interval(&self.scalars, 1.0);
        let sample = interval.between([&self.a, &self.a]);
        let terms = action.intervals.terms.iter();
        let potential = terms.filter(|term| term.kind() == TermKind::Potential);
        potential.map(|term| term.energy(&sample)).sum()
    }

    /// Brings coordinates onto the constraints by the shortest way, and potentials to Gauss's law; `None` where that fails.
    pub(super) fn settle(&mut self, state: &mut RestState, voltages: &[f64]) -> Option<()> {
        let map = &self.model.action.map;
        if map.multipliers > 0 {
            self.meet_constraints(state)?;
        }
        if !self.model.variables.algebraic().is_empty() {
            let m = map.unknowns();
            self.evaluate(state, voltages);
            let update = self.potentials()?;
            for (value, update) in state[m..].iter_mut().zip(&update) {
                *value -= update;
            }
        }
        state.iter().all(|v| v.is_finite()).then_some(())
    }

    /// Newton on the constraints alone, in the metric of the scales.
    fn meet_constraints(&mut self, state: &mut RestState) -> Option<()> {
        let action = &self.model.action;
        let (n, m) = (action.map.coordinates, action.map.unknowns());
        for _ in 0..ITERATIONS {
            let a = &mut self.a;
            a.z[..n].copy_from_slice(&state[..n]);
            // The gradients of the constraints alone: no multiplier bends them.
            a.z[n..m].fill(0.0);
            a.z[m..].copy_from_slice(&state.charts);
            action.map.place(a);
            a.forces.fill(Vector::zeros());
            self.values.fill(0.0);
            action.evaluate_instant(Order::Hessian, a, &[], &mut self.scratch);
            action.pull_back_instant(Order::Hessian, a, 0, &mut self.scratch, &mut self.values);
            self.residual.fill(0.0);
            action.rows(a, &self.scratch, &mut self.residual[..m]);
            self.residual[..n].fill(0.0);
            let added = self.values[self.added..].iter_mut();
            for (value, scale) in added.zip(self.scales[..n].iter().chain(&self.scales[m..])) {
                *value = -1.0 / (scale * scale);
            }
            let tangent = self.matrix.direct_mut()?;
            let outcome = tangent.factor(&self.values);
            self.values[self.added..].fill(0.0);
            outcome.ok()?;
            let mut update = std::mem::take(&mut self.residual);
            self.solve(&mut update);
            let size = self.size(&update);
            *state = self.moved(state, -1.0, &update[..n]);
            self.residual = update;
            if size.is_nan() {
                return None;
            }
            if size < LEAST_UPDATE {
                return Some(());
            }
        }
        None
    }
}
