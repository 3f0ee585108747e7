//! Energy of states of rest, and the way onto the constraints and to Gauss's law.

use crate::coordinates::{Configuration, Interval};
use crate::dynamics::equilibrium::rest_state::RestState;
use crate::dynamics::equilibrium::statics::{ITERATIONS, Statics};
use crate::functional::{Order, TermKind};
use crate::math::Vector;

/// Size of the last correction, relative to angles of one radian and the length of the system.
const UPDATE: f64 = 1e-12;

impl Statics<'_> {
    /// Potential energy in N mm of a state under voltages, all weights acting; the instant stays placed there.
    pub(super) fn energy(&mut self, state: &RestState, voltages: &[f64]) -> f64 {
        let action = &self.model.action;
        let m = action.map.unknowns();
        let variables = &self.model.variables;
        self.scalars[variables.inputs()].copy_from_slice(voltages);
        self.scalars[variables.algebraic()].copy_from_slice(&state[m..]);
        self.place(state);
        let interval = Interval::given(&self.scalars, 1.0);
        let sample = interval.sample([&self.a, &self.a]);
        let terms = action.intervals.terms.iter();
        let potential = terms.filter(|term| term.kind() == TermKind::Potential);
        potential.map(|term| term.energy(&sample)).sum()
    }

    /// The instant placed last.
    pub(super) fn instant(&self) -> &Configuration {
        &self.a
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
            a.z[m..].copy_from_slice(state.charts());
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
            if size < UPDATE {
                return Some(());
            }
        }
        None
    }
}
