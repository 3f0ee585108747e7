//! The midpoint variational integrator: the rows of one instant of the discrete Euler–Lagrange equations.
//!
//! With the momentum p_k = P_kᵀ (D₂L_d(q_{k−1}, q_k) + f⁺) known, the unknowns u_{k+1} and λ_k solve
//!
//! ```text
//! p_k + P_kᵀ [ D₁L_d(q_k, q_{k+1}) + f⁻ − h₀ G(q_k)ᵀ λ_k ] = 0,     g(q_{k+1}) = 0,     ∂V/∂φ (q_{k+½}, φ_{k+½}) = 0
//! ```
//!
//! with the potentials φ of the interval, which have no inertia, by Gauss's law.

use crate::coordinates::{Configuration as Place, Scratch};
use crate::dynamics::newton_matrix::NewtonMatrix;
use crate::dynamics::resolution::{Balance, typical_energy};
use crate::dynamics::solving::{Drive, Newton, Solving};
use crate::dynamics::stepper::{Equations, Now, Steps};
use crate::dynamics::tangent::{EntryList, Tangent};
use crate::functional::{BlockMask, NodeBlocks, Order, Sample};
use crate::math::Vector;
use crate::model::Model;
use crate::sparse::{Backend, DENSE};
use std::{iter, slice};

/// Steps of the midpoint rule.
pub type Stepper<'m> = Steps<Midpoint<'m>>;

/// State at one instant and the storage of the rows of the next.
#[derive(Debug)]
pub struct Midpoint<'m> {
    model: &'m Model,
    here: Place,
    next: Place,
    /// Momentum P_kᵀ p_k by coordinate, in the units of an action per coordinate.
    momentum: Vec<f64>,
    momentum_next: Vec<f64>,
    /// Rates of the coordinates over the last step, and how they changed, for the first guess.
    pub(super) rates: Vec<f64>,
    changes: Vec<f64>,
    /// Changes of the coordinates in the step.
    differences: Vec<f64>,
    /// Energy in mJ relative to which rounding is seen.
    typical_energy: f64,
    /// Sizes of the coordinates.
    sizes: Vec<f64>,
    /// Lengths in ms of the last step and of the one before; zero where there was none.
    lengths: [f64; 2],
    pub(super) time: f64,
    scratch: Scratch,
    values: Vec<f64>,
    /// Voltages and potentials of the interval.
    scalars: Vec<f64>,
    /// Multipliers, and scalars with an equation, before an attempt.
    saved: [Vec<f64>; 2],
}

impl<'m> Stepper<'m> {
    /// Starts at coordinates `z` with the momentum of each coordinate at time zero.
    pub fn new(model: &'m Model, z: &[f64], momentum: &[f64], solving: Solving) -> Self {
        let map = &model.action.map;
        let n = map.coordinates;
        let (sizes, algebraic) = (model.sizes(), model.variables.algebraic());
        let (mut here, next) = (map.instant(), map.instant());
        here.z.copy_from_slice(z);
        map.place(&mut here);
        let later = |model: &Model| direct_by(model, Newton::Modified, None);
        let matrix = NewtonMatrix::new(model, solving, false, later, || {
            direct_by(model, solving.newton, solving.backend)
        });
        let mut equations = Midpoint {
            model,
            here,
            next,
            momentum: momentum.to_vec(),
            momentum_next: momentum.to_vec(),
            rates: vec![0.0; n],
            changes: vec![0.0; n],
            differences: vec![0.0; n],
            typical_energy: typical_energy(model),
            sizes: sizes[..n].to_vec(),
            lengths: [0.0; 2],
            time: 0.0,
            scratch: model.action.scratch(Order::Gradient),
            values: Vec::new(),
            scalars: vec![0.0; model.action.intervals.scalars],
            saved: [map.multipliers, algebraic.len()].map(|count| vec![0.0; count]),
        };
        if matrix.direct().is_some() {
            equations.lay_down();
        }
        let held = model.prescribed_coordinates();
        Self::by(equations, matrix, held, sizes, solving.newton)
    }

    /// The instant now.
    pub fn instant(&self) -> &Place {
        &self.equations.here
    }
}

impl Midpoint<'_> {
    /// Makes room for the values of a tangent.
    fn lay_down(&mut self) {
        let action = &self.model.action;
        self.scratch = action.scratch(Order::Hessian);
        self.values = vec![0.0; action.layout().values(1)];
    }

    /// Measures the changes of the coordinates in the step that the last update led to.
    fn measure_step(&mut self) {
        let n = self.differences.len();
        let ends = [&self.here.z[..n], &self.next.z[..n]];
        self.model
            .action
            .map
            .differences(ends, &mut self.differences);
    }
}

impl Equations for Midpoint<'_> {
    fn begin(&mut self, step: [f64; 2], drive: &dyn Drive) {
        self.scalars[self.model.variables.inputs()].copy_from_slice(&drive.at(step, 0.5));
    }

    fn guess(&mut self, h: f64) {
        let n = self.model.action.map.coordinates;
        let [last, before] = self.lengths;
        // Rates belong to the middle of steps; the last change took from the middle of one to that of the other.
        let ratio = match before > 0.0 {
            true => (h + last) / (last + before),
            false => 1.0,
        };
        for i in 0..n {
            self.next.z[i] = self.here.z[i] + h * (self.rates[i] + ratio * self.changes[i]);
        }
        self.model.prescribe(self.time + h, &mut self.next.z);
        let m = self.model.action.map.unknowns();
        let [multipliers, scalars] = &mut self.saved;
        multipliers.copy_from_slice(&self.here.z[n..m]);
        scalars.copy_from_slice(&self.scalars[self.model.variables.algebraic()]);
        // Multipliers, and the charts: both ends of a step have the same.
        self.next.z[n..].copy_from_slice(&self.here.z[n..]);
    }

    fn evaluate(
        &mut self,
        order: Order,
        h: f64,
        residual: &mut [f64],
        nodes: Option<&mut NodeBlocks>,
    ) {
        let has_values = order >= Order::Hessian && nodes.is_none();
        if has_values && self.values.is_empty() {
            // Factors take over.
            self.lay_down();
        }
        let action = &self.model.action;
        let (n, m) = (action.map.coordinates, action.map.unknowns());
        let Self {
            here,
            next,
            scratch,
            values,
            scalars,
            ..
        } = self;
        action.map.place(next);
        for instant in [&mut *here, &mut *next] {
            instant.forces.fill(Vector::zeros());
        }
        if has_values {
            // What stands before and behind is read where there are multipliers.
            let layout = action.layout();
            let read = match m > n {
                true => 0..values.len(),
                false => layout.upper_at(0)..layout.same_at(1),
            };
            values[read].fill(0.0);
        }
        residual[..n].copy_from_slice(&self.momentum);
        residual[n..].fill(0.0);
        let interval = Sample {
            sides: BlockMask::FORWARD,
            ..Sample::of_interval(scalars, h)
        };
        match nodes {
            Some(nodes) => action.evaluate_at_nodes([here, next], &interval, scratch, nodes),
            None => {
                action.evaluate_interval(order, [here, next], &interval, scratch);
                action.pull_back_interval(order, [here, next], &interval, 0, scratch, values);
            }
        }
        let rows = &scratch.interval.plain.rows[self.model.variables.algebraic()];
        residual[m..].copy_from_slice(rows);
        if m > n {
            // Multipliers of the step act at its start, constraints hold at its end.
            action.evaluate_instant(order, next, &[], scratch);
            action.pull_back_instant(order, next, 1, scratch, values);
            residual[n..m].copy_from_slice(&scratch.instant.plain.rows);
            here.z[n..m].copy_from_slice(&next.z[n..m]);
            action.evaluate_instant(order, here, &[], scratch);
            action.pull_back_instant(order, here, 0, scratch, values);
        }
        action
            .map
            .pull_back(&here.columns, &here.forces, &mut residual[..n]);
    }

    fn values(&self) -> &[f64] {
        &self.values
    }

    fn update(&mut self, update: &[f64]) {
        let m = self.model.action.map.unknowns();
        for (z, update) in self.next.z[..m].iter_mut().zip(update) {
            *z -= update;
        }
        let scalars = &mut self.scalars[self.model.variables.algebraic()];
        for (scalar, update) in scalars.iter_mut().zip(&update[m..]) {
            *scalar -= update;
        }
    }

    fn restore(&mut self) {
        let map = &self.model.action.map;
        let [multipliers, scalars] = &self.saved;
        self.here.z[map.coordinates..map.unknowns()].copy_from_slice(multipliers);
        self.scalars[self.model.variables.algebraic()].copy_from_slice(scalars);
    }

    fn model(&self) -> &Model {
        self.model
    }

    fn place_end(&mut self) {
        self.model.action.map.place(&mut self.next);
    }

    fn ends(&self) -> [&Place; 2] {
        [&self.here, &self.next]
    }

    fn balance(&mut self, h: f64) -> Option<Balance> {
        let Self {
            model,
            here,
            next,
            scratch,
            scalars,
            typical_energy,
            ..
        } = self;
        let interval = Sample {
            sides: BlockMask::FORWARD,
            ..Sample::of_interval(scalars, h)
        };
        let action = &model.action;
        action.evaluate_interval(Order::Gradient, [here, next], &interval, scratch);
        let ends = [&*here, &*next];
        let parts = iter::once((1.0, interval.between(ends), &scratch.interval.plain.forces));
        let ends = ends.map(|at| interval.between([at, at]));
        Some(Balance::new(model, *typical_energy, 0.0, ends, parts))
    }

    /// h³ u‴/12 with the third derivative of the last three rates; before the first step the system moved as at its start.
    fn local_error(&mut self, h: f64) -> f64 {
        self.measure_step();
        let lengths = self.lengths.map(|l| if l > 0.0 { l } else { h });
        let [last, before] = lengths;
        let spans = [h + last, last + before].map(|span| 0.5 * span);
        let mut worst = 0.0_f64;
        for (i, difference) in self.differences.iter().enumerate() {
            let slope = (difference / h - self.rates[i]) / spans[0];
            let third = (slope - self.changes[i] / spans[1]) * 2.0 / (spans[0] + spans[1]);
            worst = worst.max((third / self.sizes[i]).abs());
        }
        worst * h.powi(3) / 12.0
    }

    fn visit_state(&mut self, visit: &mut dyn FnMut(&'static str, &mut [f64])) {
        visit("time", slice::from_mut(&mut self.time));
        visit("z", &mut self.here.z);
        visit("momentum", &mut self.momentum);
        visit("rates", &mut self.rates);
        visit("changes", &mut self.changes);
        visit("lengths", &mut self.lengths);
        visit("scalars", &mut self.scalars);
    }

    fn take_state(&mut self) {
        self.model.action.map.place(&mut self.here);
    }

    /// With the forces that the balance evaluated.
    fn accept(&mut self, h: f64) -> bool {
        self.measure_step();
        let action = &self.model.action;
        let Self {
            here,
            next,
            scratch,
            ..
        } = self;
        self.momentum_next.fill(0.0);
        let forces = &scratch.interval.plain.forces[1];
        let map = &action.map;
        map.pull_back(&next.columns, forces, &mut self.momentum_next);
        if !self.momentum_next.iter().all(|p| p.is_finite()) {
            return false;
        }
        std::mem::swap(&mut self.momentum, &mut self.momentum_next);
        let is_first = self.lengths[0] == 0.0;
        for (i, rate) in self.rates.iter_mut().enumerate() {
            let new = self.differences[i] / h;
            // In the first step nothing is known of the change.
            self.changes[i] = if is_first { 0.0 } else { new - *rate };
            *rate = new;
        }
        self.lengths = [h, self.lengths[0]];
        let (n, m) = (map.coordinates, map.unknowns());
        here.z[n..m].copy_from_slice(&next.z[n..m]);
        if map.recentre(next) {
            self.momentum.fill(0.0);
            map.pull_back(&next.columns, forces, &mut self.momentum);
        }
        std::mem::swap(&mut self.here, &mut self.next);
        self.time += h;
        true
    }

    fn unknown_name(&self, unknown: usize) -> String {
        self.model.variables.unknown(unknown).to_string()
    }

    fn now(&self) -> Now<'_> {
        let map = &self.model.action.map;
        Now {
            time: self.time,
            z: &self.here.z,
            momentum: &self.momentum,
            scalars: &self.scalars,
            // Those of the step stay in the list of both of its ends.
            multipliers: &self.here.z[map.coordinates..map.unknowns()],
        }
    }
}

/// The matrix of a step, factorised.
fn direct_by(model: &Model, newton: Newton, backend: Option<Backend>) -> Tangent {
    let map = &model.action.map;
    let (n, layout) = (map.coordinates, model.action.layout());
    let mut entries = EntryList::default();
    for (slot, entry) in layout.cross.entries().enumerate() {
        entries.add(layout.upper_at(0) + slot, entry);
    }
    for (slot, (row, col)) in layout.same.entries().enumerate() {
        if row < n && col >= n {
            entries.add(layout.same_at(0) + slot, (row, col));
        }
        if row >= n && col < n {
            entries.add(layout.same_at(1) + slot, (row, col));
        }
    }
    entries.add_scalars(model, &[[0, 1]]);
    entries.hold(&model.prescribed_coordinates(), 1.0);
    let (size, symmetry) = (model.variables.unknown_count(), model.step_symmetry());
    let is_corrected = newton == Newton::Modified && backend.is_none();
    match is_corrected && map.multipliers == 0 && size > DENSE {
        true => entries.corrected_tangent(model, symmetry),
        false => entries.tangent(size, symmetry, backend),
    }
}
