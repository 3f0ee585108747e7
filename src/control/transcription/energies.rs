//! Energies of sources as costs: their sum, its gradient, and second derivatives by voltages.
//!
//! Second derivatives by coordinates enter the sweep like those of a limit whose costate is the factor of the capacitance.

use crate::control::transcription::Transcription;
use crate::control::transcription::energy_rows::{EnergyRow, Jump};
use crate::control::transcription::kinematic_state::Placed;
use crate::control::transcription::limit_rows::Site;
use crate::math::Vector;

impl Transcription<'_> {
    fn capacitance(&self, row: &EnergyRow, k: usize) -> f64 {
        let measure = Site::Instants.measure(self.model, row.measure);
        measure.value(&self.sample(Site::Instants, k))
    }

    /// The energies.
    pub(super) fn energies(&mut self) -> f64 {
        if self.objective.energies.is_empty() {
            return 0.0;
        }
        self.place(Placed::Vectors);
        let count = self.model.action.layout().interval_scalars;
        let mut sum = 0.0;
        for row in &self.objective.energies {
            for k in 0..=self.layout.intervals {
                let factor = row.factor(k, &self.workspace.scalars, count).value;
                sum += factor * self.capacitance(row, k);
            }
        }
        sum
    }

    /// Adds the gradient by coordinates and voltages to the rows, step by step.
    pub(super) fn energy_gradients(&mut self) {
        self.place(Placed::Columns);
        let pattern = self.model.action.layout();
        let (stride, coordinates) = (self.stride(), pattern.unknowns);
        let count = pattern.interval_scalars;
        let mut forces = std::mem::take(&mut self.workspace.measured.forces);
        for index in 0..self.objective.energies.len() {
            for k in 0..=self.layout.intervals {
                let row = &self.objective.energies[index];
                let factor = row.factor(k, &self.workspace.scalars, count);
                let capacitance = self.capacitance(row, k);
                for (side, slope) in factor.slopes.into_iter().enumerate() {
                    if let Some(interval) = interval(k, side, self.layout.intervals) {
                        let at = interval * stride + coordinates + row.scalar;
                        self.workspace.rows[at] += capacitance * slope;
                    }
                }
                self.add_slope(index, k, factor.value, k * stride, &mut forces);
            }
        }
        self.workspace.measured.forces = forces;
    }

    /// Adds a factor times the gradient of a capacitance by the coordinates of instant k to the rows from `first` on.
    fn add_slope(
        &mut self,
        index: usize,
        k: usize,
        factor: f64,
        first: usize,
        forces: &mut [Vec<Vector>; 2],
    ) {
        let map = &self.model.action.map;
        let row = &self.objective.energies[index];
        let measure = Site::Instants.measure(self.model, row.measure);
        let sample = self.sample(Site::Instants, k);
        measure.gradient(&sample, forces, &mut []);
        let rows = &mut self.workspace.rows[first..first + map.unknowns()];
        for &vector in &row.vectors {
            let force = std::mem::replace(&mut forces[0][vector], Vector::zeros()) * factor;
            map.pull_back_one(vector, &self.workspace.instants[k].columns, &force, rows);
        }
    }

    /// Adds σ times the second derivatives by the voltages, and by voltages and coordinates, to the values.
    pub(super) fn energy_curvature(&mut self, sigma: f64) {
        if self.objective.energies.is_empty() {
            return;
        }
        self.place(Placed::Columns);
        let pattern = self.model.action.layout();
        let count = pattern.interval_scalars;
        let mut forces = std::mem::take(&mut self.workspace.measured.forces);
        self.workspace.rows[..pattern.unknowns].fill(0.0);
        for index in 0..self.objective.energies.len() {
            for k in 0..=self.layout.intervals {
                // The gradient of the capacitance, in the storage of one instant's rows.
                self.add_slope(index, k, sigma, 0, &mut forces);
                let row = &self.objective.energies[index];
                let factor = row.factor(k, &self.workspace.scalars, count);
                let capacitance = sigma * self.capacitance(row, k);
                for side in 0..2 {
                    let Some(interval) = interval(k, side, self.layout.intervals) else {
                        continue;
                    };
                    self.workspace.values[pattern.scalars_at(interval) + row.square] +=
                        capacitance * factor.squares[side];
                    // Instant k ends the interval before it, and begins the one after it.
                    let mixed = pattern.mixed_at(interval, 1 - side);
                    for &(i, slot) in &row.mixed {
                        self.workspace.values[mixed + slot] +=
                            factor.slopes[side] * self.workspace.rows[i];
                    }
                }
                for &(i, _) in &row.mixed {
                    self.workspace.rows[i] = 0.0;
                }
            }
        }
        self.workspace.measured.forces = forces;
    }

    /// σ times the second derivative by the voltages of a jump, in their units.
    pub(super) fn energy_coupling(&self, jump: Jump, sigma: f64) -> f64 {
        let Some(index) = jump.energy else {
            return 0.0;
        };
        let row = &self.objective.energies[index];
        let count = self.model.action.layout().interval_scalars;
        let product = row.factor(jump.k, &self.workspace.scalars, count).product;
        let input = &self.objective.inputs[jump.input];
        let volts = input.size;
        sigma * product * self.capacitance(row, jump.k) * volts * volts
    }
}

/// The interval before (`side` 0) or after (1) instant k, where there is one.
fn interval(k: usize, side: usize, intervals: usize) -> Option<usize> {
    match side {
        0 => k.checked_sub(1),
        _ => (k < intervals).then_some(k),
    }
}
