//! The transcription as a nonlinear program: values, derivatives and structures for the solver, and voltages whose squares it may take as unknowns.

use crate::control::limits::{BoundedQuantity, When};
use crate::control::numbering::{Column, Row};
use crate::control::transcription::Transcription;
use crate::control::transcription::cost_rows::{MILLISECOND, Objective};
use crate::control::transcription::limit_rows::Site;
use crate::control::transcription::workspace::Workspace;
use crate::functional::Order;
use crate::model::Role;
use crate::nlp::{Bounds, Entries, Nlp, Stage};

impl Nlp for Transcription<'_> {
    fn variables(&self) -> &Bounds {
        &self.bounds
    }

    fn constraints(&self) -> &Bounds {
        &self.row_bounds
    }

    fn jacobian_structure(&self) -> Entries {
        self.structure.jacobian.entries.clone()
    }

    fn hessian_structure(&self) -> Entries {
        self.structure.hessian.entries.clone()
    }

    fn objective(&mut self, x: &[f64]) -> f64 {
        self.load(x);
        let Workspace { inputs, h, .. } = &self.workspace;
        let of_inputs = self.objective.cost.value(inputs, h * MILLISECOND);
        of_inputs + self.costs() + self.energies()
    }

    fn objective_scale(&self) -> f64 {
        self.objective.scale
    }

    fn gradient(&mut self, x: &[f64], grad: &mut [f64]) {
        self.load(x);
        let Workspace {
            inputs,
            h,
            gradient,
            ..
        } = &mut self.workspace;
        let cost = &self.objective.cost;
        let mut by_horizon = cost.gradient(inputs, *h * MILLISECOND, gradient);
        by_horizon *= MILLISECOND;
        grad.fill(0.0);
        if !self.objective.quantities.is_empty() || !self.objective.energies.is_empty() {
            by_horizon +=
                self.cost_gradients(|s| s.outer.slope, |s, by_h| s.by_h + s.outer.slope * by_h);
            self.energy_gradients();
            self.gather_cost_gradient(grad);
        }
        let scales = &self.variable_scales;
        let inputs = &self.objective.inputs;
        for entry in &self.layout.unknowns.inputs {
            let (scale, unit) = (scales[entry.column], inputs[entry.input].unit);
            grad[entry.column] += self.workspace.gradient[entry.place] * scale / unit;
        }
        if let Some(column) = self.layout.unknowns.horizon() {
            grad[column] = by_horizon * scales[column];
        }
    }

    fn constraint(&mut self, x: &[f64], g: &mut [f64]) {
        self.load(x);
        self.sweep(Order::Gradient);
        let stride = self.stride();
        let count = self.model.action.map.unknowns();
        let (coordinates, span) = (self.model.coordinate_count(), self.layout.span);
        for (value, (row, scale)) in g
            .iter_mut()
            .zip(self.layout.unknowns.rows.iter().zip(&self.row_scales))
        {
            *value = scale
                * match *row {
                    Row::Instant { k, i } => {
                        let momentum = self.momenta.at(k, i, x, &self.variable_scales);
                        let again = match span.is_closed && k == 0 && i < coordinates {
                            true => self.workspace.rows[span.all * stride + i],
                            false => 0.0,
                        };
                        self.workspace.rows[k * stride + i] + momentum + again
                    }
                    Row::Interval { k, s } => self.workspace.rows[k * stride + count + s],
                    Row::Time { place, .. } => self.time_value(place, x),
                    Row::Limit { limit, k } => self.limit_value(&self.layout.limits[limit], k),
                };
        }
    }

    fn jacobian(&mut self, x: &[f64], values: &mut [f64]) {
        self.load(x);
        self.sweep(Order::Hessian);
        self.limit_gradients();
        self.time_gradients();
        for (value, kept) in values.iter_mut().zip(&self.structure.jacobian.kept) {
            *value = kept.scale * self.workspace.values[kept.place];
        }
        for (entry, slope) in self.momenta.slopes() {
            values[entry] += self.structure.jacobian.kept[entry].scale * slope;
        }
    }

    fn hessian(&mut self, x: &[f64], sigma: f64, costates: &[f64], values: &mut [f64]) {
        self.load(x);
        self.load_costates(sigma, costates);
        self.sweep(Order::Third);
        self.objective_curvature(sigma);
        self.energy_curvature(sigma);
        self.time_curvature(costates);
        let tau = self.workspace.h * MILLISECOND;
        let (own, coupling) = values.split_at_mut(self.structure.hessian.kept.len());
        for (value, kept) in own.iter_mut().zip(&self.structure.hessian.kept) {
            *value = kept.scale * self.workspace.values[kept.place];
        }
        let Objective { cost, inputs, .. } = &self.objective;
        let of_rate = sigma * cost.coupling(tau);
        for (value, &jump) in coupling.iter_mut().zip(&self.structure.jumps) {
            let scale = inputs[jump.input].scale;
            *value = of_rate * scale * scale + self.energy_coupling(jump, sigma);
        }
    }

    fn squares(&self) -> Vec<usize> {
        self.voltages_by_squares()
    }

    fn stages(&self) -> Option<Vec<Stage>> {
        let role = |column: &Column| column.of(&self.model.variables).role;
        let stage = |column: &Column| match *column {
            // A step finds multipliers and potentials together with the motion at its end.
            Column::Instant { k, .. } if role(column) == Role::Multiplier => {
                Stage::Multiplier(2 * k as u32 + 2)
            }
            // A motion that comes back couples its ends.
            Column::Instant { k: 0, .. }
                if self.layout.span.is_closed && self.layout.span.end > 1 =>
            {
                Stage::Border
            }
            Column::Instant { k, .. } => Stage::Of(2 * k as u32),
            Column::Interval { k, .. } if role(column).has_equation() => {
                Stage::Of(2 * k as u32 + 2)
            }
            Column::Interval { k, .. } => Stage::Of(2 * k as u32 + 1),
            Column::Parameter { .. } | Column::Horizon => Stage::Border,
        };
        Some(self.layout.unknowns.columns.iter().map(stage).collect())
    }

    fn variable_name(&self, i: usize) -> String {
        let column = self.layout.unknowns.columns[i];
        let name = column.of(&self.model.variables);
        match column {
            Column::Instant { k, .. } => format!("{name} at instant {k}"),
            Column::Interval { k, .. } => format!("{name} in interval {k}"),
            Column::Parameter { .. } | Column::Horizon => name.to_string(),
        }
    }

    fn constraint_name(&self, i: usize) -> String {
        let row = self.layout.unknowns.rows[i];
        let variable = row.of(&self.model.variables);
        let name = variable.map_or("", |variable| &variable.name);
        match (row, variable.map(|variable| variable.role)) {
            (Row::Limit { limit, k }, _) => {
                let BoundedQuantity {
                    name,
                    quantity,
                    when,
                    ..
                } = self.limit(limit);
                match when {
                    When::Goal | When::At(_) | When::Never => name.clone(),
                    When::Everywhere => format!("{name} {} {k}", quantity.when()),
                }
            }
            (Row::Time { of, .. }, _) => {
                let column = self.layout.unknowns.columns.iter().position(|c| *c == of);
                let name = self.variable_name(column.expect("a column of the program"));
                format!("{name}, a function of time")
            }
            (Row::Instant { k, .. }, Some(Role::Multiplier)) => {
                format!("constraint {name} at instant {k}")
            }
            (Row::Instant { k, .. }, _) if k == self.layout.span.end => {
                format!("rest at the goal, {name}")
            }
            (Row::Instant { k, .. }, _) if k > self.layout.span.end => {
                format!("equilibrium at the goal, {name}")
            }
            (Row::Instant { k, .. }, _) => format!("motion at instant {k}, {name}"),
            (Row::Interval { k, .. }, _) => format!("Gauss's law of {name} in interval {k}"),
        }
    }
}

impl Transcription<'_> {
    /// Columns of voltages between zero and a bound that enter by their squares alone: sources that drive lumped muscles and nothing else,
    /// where the objective has no rate and no energy.
    pub(super) fn voltages_by_squares(&self) -> Vec<usize> {
        if !self.objective.cost.is_of_squares() || !self.objective.energies.is_empty() {
            return Vec::new();
        }
        let model = self.model;
        let terms = model.action.intervals.terms.iter();
        let limits = self.layout.limits.iter();
        let limits = limits.filter(|limit| limit.site == Site::Intervals);
        let others = terms
            .flat_map(|term| term.not_by_squares())
            .chain(
                limits.flat_map(|limit| limit.site.measure(model, limit.measure).not_by_squares()),
            )
            .chain(
                self.objective
                    .quantities
                    .iter()
                    .flat_map(|cost| cost.scalars.clone()),
            );
        let others: Vec<usize> = others.collect();
        let is_square = |&i: &usize| {
            let column = self.layout.unknowns.columns[i];
            let (low, high) = (self.bounds.lower[i], self.bounds.upper[i]);
            let is_voltage = column.of(&model.variables).role == Role::Voltage;
            let Column::Interval { s, .. } = column else {
                return false;
            };
            is_voltage && low == 0.0 && high > 0.0 && high.is_finite() && !others.contains(&s)
        };
        (0..self.layout.unknowns.columns.len())
            .filter(is_square)
            .collect()
    }
}
