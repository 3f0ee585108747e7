//! Scales of rows and variables, and bounds.

use crate::control::numbering::{Column, Row};
use crate::control::problem::{Control, Duration, PathConstraint};
use crate::control::transcription::Transcription;
use crate::dynamics::DiscreteTrajectory;
use crate::model::{Coordinates, Role, Time};
use crate::nlp::{Bounds, Nlp};

impl Transcription<'_> {
    /// Scales rows and multipliers by the largest entries of the Jacobian at the guess, kind by kind.
    pub(super) fn set_scales(&mut self, history: &DiscreteTrajectory, h: f64) {
        let variables = &self.model.variables;
        let count = self.model.action.motion.unknowns();
        let x = self.encode(history, h);
        let mut values = vec![0.0; self.jacobian.len()];
        self.jacobian(&x, &mut values);
        // Place of a multiplier in its instant.
        let multiplier = |column: Column| match (column, column.of(variables).role) {
            (Column::Instant { i, .. }, Role::Multiplier) => Some(i),
            _ => None,
        };
        let kind = |row: Row| match row {
            Row::Instant { i, .. } => Some(i),
            Row::Interval { s, .. } => Some(count + s),
            Row::Limit { .. } => None,
        };
        let mut largest = vec![0.0_f64; self.stride()];
        let entries = || {
            self.jacobian_entries
                .rows
                .iter()
                .zip(&self.jacobian_entries.cols)
                .zip(&values)
        };
        let scale = |col: u32| self.variable_scales[col as usize];
        let is_of_horizon = |col: u32| {
            self.unknowns.columns[col as usize]
                .of(variables)
                .role
                .time()
                == Time::Horizon
        };
        for ((&row, &col), value) in entries() {
            if let (Some(i), None) = (
                kind(self.unknowns.rows[row as usize]),
                multiplier(self.unknowns.columns[col as usize]),
            ) && !is_of_horizon(col)
            {
                largest[i] = largest[i].max((value * scale(col)).abs());
            }
        }
        let inverse = |v: f64| {
            if v.is_finite() && v > 0.0 {
                1.0 / v
            } else {
                1.0
            }
        };
        let row_scales: Vec<f64> = largest.iter().map(|&v| inverse(v)).collect();
        let mut columns = vec![0.0_f64; count];
        for ((&row, &col), value) in entries() {
            let (row, column) = (
                self.unknowns.rows[row as usize],
                self.unknowns.columns[col as usize],
            );
            if let (Some(r), Some(i)) = (kind(row), multiplier(column)) {
                columns[i] = columns[i].max((value * row_scales[r]).abs());
            }
        }
        for (scale, &column) in self.variable_scales.iter_mut().zip(&self.unknowns.columns) {
            if let Some(i) = multiplier(column) {
                *scale = inverse(columns[i]);
            }
        }
        for (scale, row) in self.row_scales.iter_mut().zip(&self.unknowns.rows) {
            *scale = match *row {
                Row::Limit { limit, .. } => self.limits[limit].scale,
                other => kind(other).map_or(1.0, |i| row_scales[i]),
            };
        }
        for ((kept, &row), &col) in self
            .jacobian
            .iter_mut()
            .zip(&self.jacobian_entries.rows)
            .zip(&self.jacobian_entries.cols)
        {
            kept.scale = self.row_scales[row as usize] * self.variable_scales[col as usize];
        }
        for ((kept, &row), &col) in self
            .hessian
            .iter_mut()
            .zip(&self.hessian_entries.rows)
            .zip(&self.hessian_entries.cols)
        {
            kept.scale = self.variable_scales[row as usize] * self.variable_scales[col as usize];
        }
        self.point.fill(f64::NAN);
    }

    pub(super) fn set_bounds(&mut self, control: &Control) {
        let n = self.model.coordinate_count();
        let mut lower = vec![f64::NEG_INFINITY; n];
        let mut upper = vec![f64::INFINITY; n];
        if self.model.coordinates == Coordinates::Reduced {
            for limit in &control.limits {
                if let PathConstraint::JointAngle { joint, min, max } = *limit
                    && let Some(c) = self.model.gauges[joint].coordinate
                {
                    (lower[c], upper[c]) = (lower[c].max(min), upper[c].min(max));
                }
            }
        }
        let bound = |(&column, &scale): (&Column, &f64)| {
            let [low, high] = match (column, column.of(&self.model.variables).role) {
                (Column::Instant { i, .. }, Role::Coordinate) => [lower[i], upper[i]],
                (_, Role::Voltage) => control.voltage_bounds,
                (Column::Parameter { .. }, _) => {
                    let parameter = self.model.parameter(column.of(&self.model.variables));
                    [parameter.lower, parameter.upper]
                }
                (Column::Horizon, _) => match control.duration {
                    Duration::Free { min, max, .. } => {
                        [min, max].map(|t| t / self.intervals as f64)
                    }
                    Duration::Given(_) => [self.h; 2],
                },
                _ => [f64::NEG_INFINITY, f64::INFINITY],
            };
            (low / scale, high / scale)
        };
        let (lower, upper) = self
            .unknowns
            .columns
            .iter()
            .zip(&self.variable_scales)
            .map(bound)
            .unzip();
        self.bounds = Bounds { lower, upper };
    }

    /// Bounds of the rows: zero of equations of motion, those of limits and goals in their scale.
    pub(super) fn set_row_bounds(&mut self) {
        let Bounds { lower, upper } = &mut self.row_bounds;
        let count = self.unknowns.rows.len();
        lower.resize(count, 0.0);
        upper.resize(count, 0.0);
        for (i, row) in self.unknowns.rows.iter().enumerate() {
            if let Row::Limit { limit, .. } = *row {
                let limit = &self.limits[limit];
                lower[i] = limit.bounded.lower * limit.scale;
                upper[i] = limit.bounded.upper * limit.scale;
            }
        }
    }
}
