//! Scales of rows and variables, and bounds.

use crate::control::numbering::{Column, Numbering, Row};
use crate::control::problem::{Control, Duration};
use crate::control::transcription::Transcription;
use crate::control::transcription::layout::Layout;
use crate::dynamics::DiscreteTrajectory;
use crate::functional::ParameterOrder;
use crate::model::{Model, Role, Size, Time};
use crate::nlp::{Bounds, Nlp};
use std::mem;

/// Part of the largest inputs that motions use, about, and part of the objective of a guess that is left at the optimum.
const USUAL: f64 = 0.3;
const LEFT: f64 = 0.1;
/// A bound below this part of what a variable changes a quantity by is no scale of it, nor is an objective below this part of what inputs cost.
const SMALL: f64 = 0.01;

impl Transcription<'_> {
    /// Scales of the variables by their units; multipliers have none yet.
    pub(super) fn variable_scales(
        model: &Model,
        layout: &Layout,
        control: &Control,
        h: f64,
    ) -> Vec<f64> {
        let length = model.length();
        let scale = |column: &Column| {
            let variable = column.of(&model.variables);
            match variable.role {
                Role::Coordinate if variable.size == Size::Length => length,
                Role::Coordinate | Role::Multiplier => 1.0,
                Role::Voltage | Role::Load | Role::Potential => {
                    control.size(variable, model) / variable.unit
                }
                Role::Parameter => model.parameter(variable).size(),
                Role::Duration => h,
            }
        };
        layout.unknowns.columns.iter().map(scale).collect()
    }

    /// Scales the objective by its size.
    pub(super) fn set_objective_scale(&mut self, discrete: &DiscreteTrajectory, h: f64) {
        let x = self.encode(discrete, h);
        self.objective.scale = inverse(LEFT * self.objective_size(&x));
        self.workspace.point.fill(f64::NAN);
    }

    /// Scales rows and multipliers by the largest entries of the Jacobian at the guess, kind by kind, parameters left out.
    pub(super) fn set_scales(&mut self, discrete: &DiscreteTrajectory, h: f64) {
        let x = self.encode(discrete, h);
        let mut values = vec![0.0; self.structure.jacobian.kept.len()];
        let asked = mem::replace(&mut self.sides.parameters, ParameterOrder::None);
        self.jacobian(&x, &mut values);
        self.sides.parameters = asked;
        self.set_limit_scales(&values);
        let of_kinds = self.scales_of_kinds(&values);
        let of_multipliers = self.scales_of_multipliers(&values, &of_kinds);
        let columns = self.layout.unknowns.columns.iter();
        for (scale, &column) in self.variable_scales.iter_mut().zip(columns) {
            if let Some(i) = multiplier(column, self.model) {
                *scale = of_multipliers[i];
            }
        }
        let count = self.model.action.map.unknowns();
        let rows = self.layout.unknowns.rows.iter();
        for (scale, row) in self.row_scales.iter_mut().zip(rows) {
            *scale = match *row {
                Row::Limit { limit, .. } => self.layout.limits[limit].scale,
                Row::Time { place, .. } => {
                    1.0 / self.variable_scales[self.layout.times.column(place)]
                }
                other => kind(other, count).map_or(1.0, |i| of_kinds[i]),
            };
        }
        let (rows, columns) = (&self.row_scales, &self.variable_scales);
        self.structure.jacobian.scale(rows, columns);
        self.structure.hessian.scale(columns, columns);
        self.workspace.point.fill(f64::NAN);
    }

    /// Size of the objective: its value at the guess, or where that is a small part of it the value with usual inputs all the time, or where both are
    /// zero what it costs that every variable changes by its scale.
    fn objective_size(&mut self, x: &[f64]) -> f64 {
        let mut driven = x.to_vec();
        for input in &self.layout.unknowns.inputs {
            driven[input.column] = USUAL;
        }
        self.bounds.keep(&mut driven);
        let [of_guess, of_inputs] = [x, &driven].map(|x| self.objective(x).abs());
        match of_guess > SMALL * of_inputs {
            true => of_guess,
            false if of_inputs > 0.0 => of_inputs,
            false => self.objective_curvature_at(x),
        }
    }

    /// Half the sum of the second derivatives of the objective by each variable.
    fn objective_curvature_at(&mut self, x: &[f64]) -> f64 {
        let mut values = vec![0.0; self.structure.hessian.entries.rows.len()];
        let none = vec![0.0; self.layout.unknowns.rows.len()];
        self.hessian(x, 1.0, &none, &mut values);
        let entries = self.structure.hessian.entries.with(&values);
        let own = entries.filter(|(row, col, _)| row == col);
        own.map(|(_, _, value)| 0.5 * value.abs()).sum()
    }

    /// Scales limits and goals: limits by their bounds, as far as these are no small part of what a change of a variable by its scale makes, goals
    /// by that change alone.
    fn set_limit_scales(&mut self, values: &[f64]) {
        let mut changes = vec![0.0_f64; self.layout.limits.len()];
        for (row, col, value) in self.structure.jacobian.entries.with(values) {
            if let Row::Limit { limit, .. } = self.layout.unknowns.rows[row] {
                let change = (value * self.variable_scales[col]).abs();
                changes[limit] = changes[limit].max(change);
            }
        }
        for (limit, change) in self.layout.limits.iter_mut().zip(changes) {
            let [lower, upper] = limit.bounded.bounds();
            let sizes = [lower, upper].map(f64::abs).into_iter();
            let bound = sizes.filter(|size| size.is_finite()).fold(0.0, f64::max);
            let is_given = change > 0.0 && (lower == upper || bound == 0.0);
            limit.scale = inverse(match is_given {
                true => change,
                false => bound.max(SMALL * change),
            });
        }
    }

    /// Scale of each kind of row but limits: one over the largest entry of these rows by variables of instants and intervals.
    fn scales_of_kinds(&self, values: &[f64]) -> Vec<f64> {
        let Numbering { rows, columns, .. } = &self.layout.unknowns;
        let count = self.model.action.map.unknowns();
        let is_of_horizon = |column: Column| {
            let variable = column.of(&self.model.variables);
            variable.role.time() == Time::Horizon
        };
        let mut largest = vec![0.0_f64; self.stride()];
        for (row, col, value) in self.structure.jacobian.entries.with(values) {
            let (kind, column) = (kind(rows[row], count), columns[col]);
            if let (Some(i), None) = (kind, multiplier(column, self.model))
                && !is_of_horizon(column)
            {
                largest[i] = largest[i].max((value * self.variable_scales[col]).abs());
            }
        }
        largest.into_iter().map(inverse).collect()
    }

    /// Scale of each multiplier of an instant: one over its largest entry in scaled rows.
    fn scales_of_multipliers(&self, values: &[f64], of_kinds: &[f64]) -> Vec<f64> {
        let Numbering { rows, columns, .. } = &self.layout.unknowns;
        let count = self.model.action.map.unknowns();
        let mut largest = vec![0.0_f64; count];
        for (row, col, value) in self.structure.jacobian.entries.with(values) {
            let of = (kind(rows[row], count), multiplier(columns[col], self.model));
            if let (Some(r), Some(i)) = of {
                largest[i] = largest[i].max((value * of_kinds[r]).abs());
            }
        }
        largest.into_iter().map(inverse).collect()
    }

    pub(super) fn set_bounds(&mut self, control: &Control) {
        let n = self.model.coordinate_count();
        let mut lower = vec![f64::NEG_INFINITY; n];
        let mut upper = vec![f64::INFINITY; n];
        if self.model.has_independent_joints() {
            for limit in &control.limits {
                if let (Some(joint), None) = (limit.joint(), limit.part)
                    && let Some(c) = self.model.joint_readings[joint].coordinate
                {
                    (lower[c], upper[c]) = (lower[c].max(limit.min), upper[c].min(limit.max));
                }
            }
        }
        let times = &self.layout.times;
        let bound = |(number, (&column, &scale)): (usize, (&Column, &f64))| {
            let [low, high] = match (column, column.of(&self.model.variables).role) {
                _ if times.place(number).is_some() => [f64::NEG_INFINITY, f64::INFINITY],
                (Column::Instant { i, .. }, Role::Coordinate) => [lower[i], upper[i]],
                (_, Role::Voltage | Role::Load) => control.bounds(column.of(&self.model.variables)),
                (Column::Parameter { .. }, _) => {
                    let parameter = self.model.parameter(column.of(&self.model.variables));
                    [parameter.lower, parameter.upper]
                }
                (Column::Horizon, _) => match control.duration {
                    Duration::Free { min, max, .. } => {
                        [min, max].map(|t| t / self.layout.span.end as f64)
                    }
                    Duration::Given(_) => [self.workspace.h; 2],
                },
                _ => [f64::NEG_INFINITY, f64::INFINITY],
            };
            (low / scale, high / scale)
        };
        let (lower, upper) = self
            .layout
            .unknowns
            .columns
            .iter()
            .zip(&self.variable_scales)
            .enumerate()
            .map(bound)
            .unzip();
        self.bounds = Bounds { lower, upper };
    }

    /// Bounds of the rows: zero of equations of motion, none of what is one with other phases, those of limits and goals in their scale.
    pub(super) fn set_row_bounds(&mut self) {
        let Bounds { lower, upper } = &mut self.row_bounds;
        let count = self.layout.unknowns.rows.len();
        lower.resize(count, 0.0);
        upper.resize(count, 0.0);
        for (i, row) in self.layout.unknowns.rows.iter().enumerate() {
            if self.layout.is_of_junction(*row) {
                (lower[i], upper[i]) = (f64::NEG_INFINITY, f64::INFINITY);
            }
            if let Row::Limit { limit, k } = *row {
                let limit = &self.layout.limits[limit];
                let part = limit.part(k);
                lower[i] = limit.bounded.lower * limit.scale * part;
                upper[i] = limit.bounded.upper * limit.scale * part;
            }
        }
    }
}

/// Place of a multiplier in its instant.
fn multiplier(column: Column, model: &Model) -> Option<usize> {
    match (column, column.of(&model.variables).role) {
        (Column::Instant { i, .. }, Role::Multiplier) => Some(i),
        _ => None,
    }
}

/// Kind of a row, the place in its step; `count` is the number of unknowns of an instant. Limits and functions of time are of no kind.
fn kind(row: Row, count: usize) -> Option<usize> {
    match row {
        Row::Instant { i, .. } => Some(i),
        Row::Interval { s, .. } => Some(count + s),
        Row::Time { .. } | Row::Limit { .. } => None,
    }
}

/// One over a value; one where it is zero or infinite.
fn inverse(value: f64) -> f64 {
    if value.is_finite() && value > 0.0 {
        1.0 / value
    } else {
        1.0
    }
}
