//! Costs of quantities, their gradients, and their derivatives with the interval length.

use crate::control::boundary_conditions::BoundaryConditions;
use crate::control::numbering::{Column, Twin};
use crate::control::objective::Cost;
use crate::control::problem::Control;
use crate::control::transcription::Transcription;
use crate::control::transcription::cost_rows::{CostRow, Summand, cost_rows};
use crate::control::transcription::energy_rows::{EnergyRow, energy_rows};
use crate::control::transcription::kinematic_state::Placed;
use crate::control::transcription::layout::Layout;
use crate::functional::Horizon;
use crate::math::Vector;
use crate::model::{Model, Time, Variable};

impl Transcription<'_> {
    /// The costs of quantities.
    pub(super) fn costs(&mut self) -> f64 {
        if self.objective.quantities.is_empty() {
            return 0.0;
        }
        self.place(Placed::Vectors);
        let mut sum = 0.0;
        for cost in &self.objective.quantities {
            let measure = cost.site.measure(self.model, cost.measure);
            for k in cost.at.clone() {
                let value = measure.value(&self.sample(cost.site, k));
                sum += cost.summand(value, k, self.workspace.h).value;
            }
        }
        sum
    }

    /// Puts a factor times the gradient of each cost by coordinates and scalars into the rows, step by step; the factor is taken
    /// of its summand. Returns the sum of what `by_horizon` takes of it and of the derivative of the quantity by the interval length.
    pub(super) fn cost_gradients(
        &mut self,
        factor: impl Fn(&Summand) -> f64,
        by_horizon: impl Fn(&Summand, f64) -> f64,
    ) -> f64 {
        self.place(Placed::Columns);
        let map = &self.model.action.map;
        let (stride, coordinates) = (self.stride(), map.unknowns());
        self.workspace.rows.fill(0.0);
        let mut sum = 0.0;
        let mut part = std::mem::take(&mut self.workspace.measured);
        for cost in &self.objective.quantities {
            let measure = cost.site.measure(self.model, cost.measure);
            for k in cost.at.clone() {
                let sample = self.sample(cost.site, k);
                let summand = cost.summand(measure.value(&sample), k, self.workspace.h);
                measure.gradient(&sample, &mut part.forces, &mut part.rows);
                let factor = factor(&summand);
                let by_h = match cost.reads_rates && self.layout.horizon == Horizon::Free {
                    true => measure.by_duration(&sample),
                    false => 0.0,
                };
                sum += by_horizon(&summand, by_h);
                for side in (0..cost.site.sides()).filter(|&side| measure.reads(side)) {
                    for &vector in &cost.vectors {
                        let force = part.forces[side][vector] * factor;
                        let rows = &mut self.workspace.rows[(k + side) * stride..][..coordinates];
                        let columns = &self.workspace.instants[k + side].columns;
                        map.pull_back_one(vector, columns, &force, rows);
                    }
                }
                for &s in &cost.scalars {
                    self.workspace.rows[k * stride + coordinates + s] += part.rows[s] * factor;
                }
                for &vector in &cost.vectors {
                    for side in &mut part.forces {
                        side[vector] = Vector::zeros();
                    }
                }
                part.rows.fill(0.0);
            }
        }
        self.workspace.measured = part;
        sum
    }

    /// Adds the gradients in the rows to those by the variables.
    pub(super) fn gather_cost_gradient(&mut self, grad: &mut [f64]) {
        let (stride, coordinates) = (self.stride(), self.model.action.map.unknowns());
        if let Some(Twin { instant, of, .. }) = self.layout.twin {
            let (before, twin) = self.workspace.rows.split_at_mut(instant * stride);
            let sums = before[of * stride..][..coordinates].iter_mut();
            sums.zip(twin).for_each(|(sum, row)| *sum += *row);
        }
        let of_interval = |k: usize, s: usize| self.workspace.rows[k * stride + coordinates + s];
        let columns = self.layout.unknowns.columns.iter();
        let columns = columns.zip(&self.variable_scales);
        for (sum, (column, scale)) in grad.iter_mut().zip(columns) {
            let row = match *column {
                Column::Instant { k, i } => self.workspace.rows[k * stride + i],
                Column::Interval { k, s } => of_interval(k, s),
                Column::Parameter { s } => {
                    (0..self.layout.intervals).map(|k| of_interval(k, s)).sum()
                }
                Column::Horizon => continue,
            };
            *sum += row * scale;
        }
    }

    /// Adds σ times the derivatives of the costs with the interval length to the values.
    pub(super) fn cost_border(&mut self, sigma: f64) {
        if self.objective.quantities.is_empty() {
            return;
        }
        let square = self.cost_gradients(
            |s| sigma * s.by_value_and_h,
            |s, by_h| sigma * (s.by_h_twice + 2.0 * s.by_value_and_h * by_h),
        );
        let pattern = self.model.action.layout();
        let (stride, coordinates) = (self.stride(), self.model.action.map.unknowns());
        for k in 0..=self.layout.intervals {
            let rows = &self.workspace.rows[k * stride..][..coordinates];
            let values = &mut self.workspace.values[pattern.horizon_at(k)..][..coordinates];
            values.iter_mut().zip(rows).for_each(|(v, row)| *v += row);
            if k == self.layout.intervals {
                break;
            }
            let rows = &self.workspace.rows[k * stride + coordinates..(k + 1) * stride];
            let values = &mut self.workspace.values[pattern.horizon_scalars_at(k)..][..rows.len()];
            values.iter_mut().zip(rows).for_each(|(v, row)| *v += row);
        }
        self.workspace.values[pattern.horizon_square_at(self.layout.intervals)] += square;
    }

    /// Places all instants at the present point as far as it is needed, the copy where stretches meet too.
    pub(super) fn place(&mut self, needed: Placed) {
        let map = &self.model.action.map;
        let workspace = &mut self.workspace;
        if let Some(middle) = self.layout.middle() {
            let here = &workspace.instants[middle];
            workspace.boundary_instant.z.copy_from_slice(&here.z);
        }
        let instants = workspace.instants.iter_mut();
        for instant in instants.chain([&mut workspace.boundary_instant]) {
            if workspace.placed < Placed::Vectors {
                map.vectors(instant);
            }
            if workspace.placed < needed && needed == Placed::Columns {
                map.tangent(instant);
            }
        }
        workspace.placed = workspace.placed.max(needed);
    }
}

/// The objective of a control problem on its grid.
#[derive(Clone, Debug)]
pub(super) struct Objective {
    pub(super) cost: Cost,
    /// Costs of quantities.
    pub(super) quantities: Vec<CostRow>,
    /// Costs of energies.
    pub(super) energies: Vec<EnergyRow>,
    /// Voltages and loads of an interval.
    pub(super) inputs: Vec<CostInput>,
    /// Factor that brings the objective near 1, which follows from its value at the guess.
    pub(super) scale: f64,
}

/// A voltage or load in the objective.
#[derive(Clone, Copy, Debug)]
pub(super) struct CostInput {
    /// Its place among the scalars.
    pub(super) scalar: usize,
    /// Slot of its second derivative with itself.
    pub(super) slot: usize,
    /// Size of one kV, N or N m in the unit inside; infinite of a given one, which costs nothing.
    pub(super) unit: f64,
    /// Scale of its variable in kV, N or N m.
    pub(super) scale: f64,
    /// Scale of its variable in the unit inside.
    pub(super) size: f64,
}

impl CostInput {
    /// The voltages and loads of an interval of a model.
    fn of_model(model: &Model, control: &Control) -> Vec<Self> {
        let slots = &model.action.layout().scalars;
        let input = |(s, variable): (usize, &Variable)| {
            let source = variable.source.expect("an input of a source");
            let unit = unit_of(model, control, source);
            let size = control.size(variable, model);
            Self {
                scalar: s,
                slot: slots
                    .find(s, s)
                    .expect("an input has a curvature of its own"),
                unit,
                scale: size / unit,
                size,
            }
        };
        let variables = &model.variables.of(Time::Interval)[model.variables.sources_range()];
        variables.iter().enumerate().map(input).collect()
    }
}

impl Objective {
    /// The objective of a problem on a layout.
    pub(super) fn new(
        model: &Model,
        boundary: &BoundaryConditions,
        (control, layout): (&Control, &Layout),
    ) -> Self {
        let objective = &control.objective;
        let (paid, energies) = (&objective.quantities, &objective.energies);
        let inputs = CostInput::of_model(model, control);
        let ends = boundary.rest.each_ref();
        let ends = ends.map(|row| row.as_ref().map(|row| counted(model, &inputs, row)));
        Self {
            cost: Cost::new(objective, inputs.len(), layout.span(), ends),
            quantities: cost_rows(
                model,
                (paid, energies),
                boundary.limits.quantities().len(),
                layout.end,
            ),
            energies: energy_rows(model, energies, &boundary.rest, layout.intervals),
            inputs,
            scale: 1.0,
        }
    }
}

/// Size of one kV, N or N m of an input in the unit inside; infinite of a given one, which costs nothing.
pub(super) fn unit_of(model: &Model, control: &Control, source: usize) -> f64 {
    match control.is_given(source) {
        true => f64::INFINITY,
        false => model.input_kind(source).counted().1,
    }
}

/// Inputs of an interval in kV, N and N m, from those of all sources.
pub(super) fn counted(model: &Model, inputs: &[CostInput], row: &[f64]) -> Vec<f64> {
    let values = model.variables.sources().map(|source| row[source]);
    let values = values.zip(inputs);
    values.map(|(value, input)| value / input.unit).collect()
}
