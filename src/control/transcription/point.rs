//! Conversion between motions and points of the program.

use crate::control::guess::InitialGuess;
use crate::control::identification::Costates;
use crate::control::numbering::{Column, Row, Span};
use crate::control::transcription::Transcription;
use crate::control::transcription::segment::Placed;
use crate::dynamics::DiscreteTrajectory;
use crate::ipopt;
use crate::nlp::Multipliers;

/// Decoder of points to motions and costates: given values together with the variables.
#[derive(Clone, Debug)]
pub struct Decoder {
    z: Vec<Vec<f64>>,
    scalars: Vec<Vec<f64>>,
    /// Scalars behind the motion.
    held: Option<Vec<f64>>,
    span: Span,
    h: f64,
    columns: Vec<(Column, usize)>,
    scales: Vec<f64>,
    row_scales: Vec<f64>,
}

impl Decoder {
    /// The motion of a point of the program.
    pub fn decode(&self, x: &[f64]) -> DiscreteTrajectory {
        let (mut z, mut scalars, mut h) = (self.z.clone(), self.scalars.clone(), self.h);
        let mut held = self.held.clone();
        let (instants, intervals) = (z.len(), scalars.len());
        for &(column, number) in &self.columns {
            let value = self.scales[number] * x[number];
            match column {
                Column::Instant { k, i } if k < instants => z[k][i] = value,
                Column::Interval { k, s } if k < intervals => scalars[k][s] = value,
                Column::Interval { s, .. } => held.iter_mut().for_each(|row| row[s] = value),
                Column::Parameter { s } => {
                    let rows = scalars.iter_mut().chain(&mut held);
                    rows.for_each(|row| row[s] = value);
                }
                Column::Horizon => h = value,
                // Multipliers behind the motion are those of no instant of it.
                Column::Instant { .. } => {}
            }
        }
        let last = self.span.all;
        if let Some(of) = self.span.twin().filter(|_| last < instants) {
            z[last] = z[of].clone();
        }
        DiscreteTrajectory {
            held,
            ..DiscreteTrajectory::in_steps(h, z, scalars)
        }
    }

    /// Unscaled costates of a point.
    pub fn costates(&self, costates: &Multipliers) -> Costates {
        unscaled(costates, &self.row_scales, &self.scales)
    }
}

impl Transcription<'_> {
    /// The variables of a motion with interval length h (ms); those that are functions of time have the values of its instants and intervals.
    pub fn encode(&self, discrete: &DiscreteTrajectory, h: f64) -> Vec<f64> {
        let map = &self.model.action.map;
        let mut z = discrete.z.clone();
        for (z, instant) in z.iter_mut().zip(&self.workspace.instants) {
            map.take_charts(&instant.z, z);
        }
        let last = discrete.held.as_ref().or(discrete.scalars.last());
        let last = last.expect("a motion has intervals");
        let value = |column: &Column| match *column {
            Column::Instant { k, i } => z.get(k).map_or(0.0, |z| z[i]),
            Column::Interval { k, s } => discrete.scalars.get(k).unwrap_or(last)[s],
            Column::Parameter { s } => discrete.scalars[0][s],
            Column::Horizon => h,
        };
        let columns = self.layout.unknowns.columns.iter();
        let mut x: Vec<f64> = columns.map(value).collect();
        for (column, value) in self.layout.times.values(h) {
            x[column] = value;
        }
        divide(&x, &self.variable_scales)
    }

    /// The motion of a point of the program.
    pub fn decode(&self, x: &[f64]) -> DiscreteTrajectory {
        self.decoder().decode(x)
    }

    /// Returns a decoder of points to motions that works without the program, which a solver holds while it works.
    pub fn decoder(&self) -> Decoder {
        let scalar_count = self.model.action.layout().interval_scalars;
        let end = self.layout.span.end;
        let scalars =
            |k: usize| self.workspace.scalars[k * scalar_count..(k + 1) * scalar_count].to_vec();
        Decoder {
            z: self.workspace.instants[..=end]
                .iter()
                .map(|instant| instant.z.clone())
                .collect(),
            scalars: (0..end).map(scalars).collect(),
            held: (end < self.layout.span.all).then(|| scalars(end)),
            span: self.layout.span,
            h: self.workspace.h,
            columns: self.layout.unknowns.variables().collect(),
            scales: self.variable_scales.clone(),
            row_scales: self.row_scales.clone(),
        }
    }

    /// A start of the solver from a guess.
    pub fn start(&self, initial: &InitialGuess) -> ipopt::StartingPoint {
        let x = self.encode(&initial.discrete, initial.h);
        let fits = |c: &&Costates| {
            c.rows.len() == self.layout.unknowns.rows.len()
                && c.lower.len() == x.len()
                && c.upper.len() == x.len()
        };
        let costates = initial.costates.as_ref().filter(fits).map(|c| Multipliers {
            constraints: divide(&c.rows, &self.row_scales),
            lower: times(&c.lower, &self.variable_scales),
            upper: times(&c.upper, &self.variable_scales),
        });
        ipopt::StartingPoint { x, costates }
    }

    /// Unscaled costates of a solution.
    pub fn costates(&self, costates: &Multipliers) -> Costates {
        unscaled(costates, &self.row_scales, &self.variable_scales)
    }

    /// Reads a point, unless it stands there already; a sweep places the instants.
    pub(super) fn load(&mut self, x: &[f64]) {
        let workspace = &mut self.workspace;
        if workspace.point == x {
            return;
        }
        workspace.point.copy_from_slice(x);
        let count = self.model.action.layout().interval_scalars;
        for (column, number) in self.layout.unknowns.variables() {
            let value = self.variable_scales[number] * x[number];
            match column {
                Column::Instant { k, i } => workspace.instants[k].z[i] = value,
                Column::Interval { k, s } => workspace.scalars[k * count + s] = value,
                Column::Parameter { s } => {
                    let rows = workspace.scalars.chunks_exact_mut(count);
                    rows.for_each(|row| row[s] = value);
                }
                Column::Horizon => workspace.h = value,
            }
        }
        self.layout
            .share(&mut workspace.instants, &self.model.action.map);
        let inputs = &self.objective.inputs;
        for entry in &self.layout.unknowns.inputs {
            let value = self.variable_scales[entry.column] * x[entry.column];
            workspace.inputs[entry.place] = value / inputs[entry.input].unit;
        }
        workspace.placed = Placed::Nothing;
    }

    /// Reads the factor of the objective and the costates, along which derivatives are contracted.
    pub(super) fn load_costates(&mut self, sigma: f64, costates: &[f64]) {
        let workspace = &mut self.workspace;
        for instant in &mut workspace.instants {
            instant.l.fill(0.0);
        }
        workspace.rows.fill(0.0);
        workspace.scalars_along.fill(0.0);
        let (rows, limits) = (&self.layout.unknowns.rows, self.layout.limit_rows.len());
        let count = self.model.action.layout().interval_scalars;
        let coordinates = self.model.coordinate_count();
        let total = workspace.rows.len() - limits;
        let first = rows.len() - limits;
        for (r, (row, y)) in rows.iter().zip(costates).enumerate() {
            let y = y * self.row_scales[r];
            match *row {
                Row::Instant { k, i } => {
                    workspace.instants[k].l[i] = y;
                    if self.layout.span.is_closed && k == 0 && i < coordinates {
                        workspace.instants[self.layout.span.all].l[i] = y;
                    }
                }
                Row::Interval { k, s } => workspace.scalars_along[k * count + s] = y,
                Row::Limit { .. } => workspace.rows[total + r - first] = y,
                Row::Time { .. } => {}
            }
        }
        workspace.sigma = sigma;
    }
}

/// Costates without the scales of rows and variables.
fn unscaled(costates: &Multipliers, rows: &[f64], variables: &[f64]) -> Costates {
    Costates {
        rows: times(&costates.constraints, rows),
        lower: divide(&costates.lower, variables),
        upper: divide(&costates.upper, variables),
    }
}

/// Entry by entry list / scales.
fn divide(list: &[f64], scales: &[f64]) -> Vec<f64> {
    list.iter().zip(scales).map(|(v, s)| v / s).collect()
}

/// Entry by entry list · scales.
fn times(list: &[f64], scales: &[f64]) -> Vec<f64> {
    list.iter().zip(scales).map(|(v, s)| v * s).collect()
}
