//! Channels read off a motion, with their derivatives by the unknowns.
//!
//! Exact derivatives of a discrete motion by constants, start coordinates and start momenta.

use crate::control::problem::{BoundaryState, Channel, Control, Duration, Voltages};
use crate::control::{Column, MotionDerivatives, StartDerivatives, ends_that_read};
use crate::coordinates::Configuration;
use crate::dynamics::{DiscreteTrajectory, Start};
use crate::functional::{Sample, SumDerivatives};
use crate::identify::error::IdentifyError;
use crate::identify::setup::Setup;
use crate::model::{Model, Quantity, Role, Time};
use nalgebra::{DMatrix, DVector, RowDVector};
use std::mem;
use std::ops::Range;

/// A motion with its derivatives by the unknowns at each instant.
#[derive(Clone, Debug)]
pub(super) struct Course<'a> {
    pub(super) model: &'a Model,
    pub(super) discrete: DiscreteTrajectory,
    pub(super) derivatives: MotionDerivatives,
    /// Times in ms at which inputs have corners or jumps.
    pub(super) corners: Vec<f64>,
    /// True of a state of rest, of which all times are the same.
    pub(super) is_still: bool,
}

/// Values and derivatives of readings by unknowns.
#[derive(Clone, Debug, PartialEq)]
pub struct Prediction {
    /// Values, recording by recording, channel by channel.
    pub values: DVector<f64>,
    /// A row of derivatives for each.
    pub derivatives: DMatrix<f64>,
}

impl Prediction {
    /// Room for a number of readings.
    pub(super) fn zeros(readings: usize, unknowns: usize) -> Self {
        Self {
            values: DVector::zeros(readings),
            derivatives: DMatrix::zeros(readings, unknowns),
        }
    }
}

/// Values at times of a grid, and their derivatives.
type Nodes = (Vec<f64>, Vec<RowDVector<f64>>);

impl Course<'_> {
    /// All channels at their readings.
    pub(super) fn read(&self, channels: &[Channel], columns: usize) -> Prediction {
        let count: usize = channels.iter().map(|one| one.readings.len()).sum();
        let mut out = Prediction::zeros(count, columns);
        let map = &self.model.action.map;
        let instants: Vec<Configuration> = self.discrete.z.iter().map(|z| map.placed(z)).collect();
        let mut row = 0;
        for channel in channels {
            for (factor, quantity) in &channel.parts {
                let nodes = self.nodes(&instants, quantity, columns);
                for (row, reading) in (row..).zip(&channel.readings) {
                    let (begin, weights) = self.weights(quantity, nodes.0.len(), reading.time);
                    for (node, weight) in (begin..).zip(weights) {
                        out.values[row] += factor * weight * nodes.0[node];
                        let mut into = out.derivatives.row_mut(row);
                        into += &nodes.1[node] * (factor * weight);
                    }
                }
            }
            row += channel.readings.len();
        }
        out
    }

    /// Times from which and between which values are known: instants, middles of intervals, or instants between two intervals.
    fn grid(&self, quantity: &Quantity) -> [f64; 2] {
        let h = self.discrete.times[1] - self.discrete.times[0];
        match (quantity.before(), quantity.is_of_intervals()) {
            (Some(_), _) => [h, h],
            (None, true) => [0.5 * h, h],
            (None, false) => [0.0, h],
        }
    }

    /// First of the nodes from which a quantity at a time in ms is interpolated, and their weights.
    fn weights(&self, quantity: &Quantity, nodes: usize, time: f64) -> (usize, Vec<f64>) {
        if self.is_still {
            return (0, vec![1.0]);
        }
        let grid = self.grid(quantity);
        let piece = piece(
            time,
            &self.corners,
            grid,
            nodes,
            quantity.before().is_some(),
        );
        weights(time, grid, piece)
    }

    /// Values of a quantity at all instants or in all intervals, and their derivatives; of one that is a step between intervals its rates.
    fn nodes(&self, instants: &[Configuration], quantity: &Quantity, columns: usize) -> Nodes {
        let [_, h] = self.grid(quantity);
        let parameters = &self.model.analysis.parameters;
        let (mut values, mut derivatives) = match ends_that_read(quantity, parameters) {
            None => self.all(instants, quantity, columns),
            Some([start, end]) => {
                let (mut values, mut derivatives) = self.all(instants, &start, columns);
                let (at_end, by_end) = self.all(instants, &end, columns);
                values.extend(at_end.last());
                derivatives.extend(by_end.last().cloned());
                (values, derivatives)
            }
        };
        if let Some(before) = quantity.before() {
            let (of_before, by_before) = self.all(instants, &before, columns);
            let count = values.len() - 1;
            return (0..count)
                .map(|k| {
                    let step = values[k + 1] - of_before[k];
                    (step / h, (&derivatives[k + 1] - &by_before[k]) / h)
                })
                .unzip();
        }
        if quantity.is_step() {
            values.iter_mut().for_each(|value| *value /= h);
            derivatives.iter_mut().for_each(|row| *row /= h);
        }
        if let Some(period) = quantity.period(&self.model.system) {
            unwrap(&mut values, period);
        }
        (values, derivatives)
    }

    /// Values of a quantity at all instants or in all intervals, and their derivatives.
    fn all(&self, instants: &[Configuration], quantity: &Quantity, columns: usize) -> Nodes {
        let sides = 1 + usize::from(quantity.is_of_intervals());
        let count = instants.len() + 1 - sides;
        let Some(place) = self.model.place_of(quantity) else {
            return (vec![0.0; count], vec![RowDVector::zeros(columns); count]);
        };
        let sum = match sides {
            1 => &self.model.action.instants,
            _ => &self.model.action.intervals,
        };
        let measure = sum.measures[place].as_ref();
        let mut vectors = measure.vectors();
        vectors.sort_unstable();
        vectors.dedup();
        let (map, layout) = (&self.model.action.map, self.model.action.layout());
        let mut part = SumDerivatives::new(map.vectors.len(), layout.interval_scalars, None);
        let mut rows = vec![0.0; map.unknowns()];
        let of = |k: usize| {
            let here = [&instants[k], &instants[k + sides - 1]];
            let scalars = self.discrete.scalars.get(k).map_or(&[][..], Vec::as_slice);
            let sample = Sample {
                vectors: here.map(|instant| &instant.x[..]),
                h: self.discrete.times[1] - self.discrete.times[0],
                ..Sample::of_instant(&here[0].x, scalars)
            };
            // What is still has the derivatives of one interval.
            let first = if self.is_still { 0 } else { k };
            let mut row = RowDVector::zeros(columns);
            let mut add = |by: Option<&RowDVector<f64>>, slope: f64| {
                if let Some(by) = by.filter(|_| slope != 0.0) {
                    row += by * slope;
                }
            };
            measure.gradient(&sample, &mut part.forces, &mut part.rows);
            for side in (0..2).filter(|&side| measure.reads(side)) {
                rows.fill(0.0);
                let (forces, columns) = (&mut part.forces[side], &here[side].columns);
                map.take_back(&vectors, columns, forces, 1.0, &mut rows);
                for (i, force) in rows[..map.coordinates].iter().enumerate() {
                    add(self.derivatives.of_coordinate(first + side, i), *force);
                }
            }
            for (s, slope) in part.rows.iter_mut().enumerate() {
                add(self.derivatives.of_scalar(first, s), mem::take(slope));
            }
            (measure.value(&sample), row)
        };
        (0..count).map(of).unzip()
    }
}

/// Makes values continue without jumps by a period.
fn unwrap(values: &mut [f64], period: f64) {
    for k in 1..values.len() {
        let turns = ((values[k - 1] - values[k]) / period).round();
        values[k] += turns * period;
    }
}

/// Fewest points between two corners from which alone a value follows; across a corner where there are fewer.
const FEWEST: usize = 4;
/// Part of a step by which a time may miss a corner.
const OFF: f64 = 1e-6;

/// Points between the corners around a time, a corner counting to what follows; without those at the corners where values jump.
fn piece(
    time: f64,
    corners: &[f64],
    [first, h]: [f64; 2],
    points: usize,
    jumps: bool,
) -> Range<usize> {
    let begin = corners.iter().copied().filter(|c| *c <= time + OFF * h);
    let end = corners.iter().copied().filter(|c| *c > time + OFF * h);
    let margin = if jumps { OFF } else { -OFF };
    let place = |corner: f64| (corner - first) / h;
    let last = (points - 1) as f64;
    let begin = begin.fold(0.0, |begin: f64, c| begin.max((place(c) + margin).ceil()));
    let end = end.fold(last, |end: f64, c| end.min((place(c) - margin).floor()));
    let piece = begin as usize..(end + 1.0).max(0.0) as usize;
    match piece.len() < FEWEST {
        true => 0..points,
        false => piece,
    }
}

/// First of the points of a piece that a value at a time follows from, and their weights; the error is of fourth order in `h`.
fn weights(time: f64, [first, h]: [f64; 2], points: Range<usize>) -> (usize, Vec<f64>) {
    let count = points.len().min(4);
    let place = (time - first) / h;
    let last = (points.end - count) as f64;
    let begin = (place.floor() - 1.0).clamp(points.start as f64, last) as usize;
    let s = place - begin as f64;
    let weight = |j: usize| {
        let others = (0..count).filter(|&i| i != j);
        let factor = |i: usize| (s - i as f64) / (j as f64 - i as f64);
        others.map(factor).product()
    };
    (begin, (0..count).map(weight).collect())
}

/// Derivatives of a motion from a start by the unknowns, of which there are `count`; of a state of rest where there is no start.
pub(super) fn derivatives(
    setup: &Setup<'_>,
    from: Option<(&Start, &StartDerivatives)>,
    discrete: &DiscreteTrajectory,
    voltages: &Voltages,
    count: usize,
) -> Result<MotionDerivatives, IdentifyError> {
    let model = &setup.model;
    let (intervals, any) = (discrete.intervals(), [f64::NEG_INFINITY, f64::INFINITY]);
    let h = discrete.times[1] - discrete.times[0];
    let control = Control {
        start: BoundaryState::Free,
        // Inputs of which something is sought have columns.
        load_bounds: setup.inputs.sought().map(|source| (source, any)).collect(),
        course: Some(voltages.clone()),
        duration: Duration::Given(h * intervals as f64),
        intervals,
        ..setup.control.clone()
    };
    let known = known(setup, discrete, from.is_some());
    let found = MotionDerivatives::new(model, &control, from, discrete, count, known);
    let found = found.map_err(|error| setup.recording.refused(error))?;
    let singular = "the equations of its derivatives are singular";
    found.ok_or_else(|| setup.recording.refused(singular))
}

/// Tells the columns that are functions of the constants, and their derivatives: constants themselves, and inputs with gains or delays.
fn known<'a>(
    setup: &'a Setup<'_>,
    discrete: &'a DiscreteTrajectory,
    moves: bool,
) -> impl Fn(&Column) -> Option<Vec<(usize, f64)>> + 'a {
    let variables = &setup.model.variables;
    let first = variables.range(Role::Parameter).start;
    move |column| match *column {
        Column::Parameter { s } => Some(vec![(s - first, 1.0)]),
        Column::Interval { k, s } => {
            let source = variables.of(Time::Interval)[s].source?;
            let times = [discrete.times[k], discrete.times[k + 1]];
            let interval = moves.then_some(times);
            let value = discrete.scalars[k][s];
            setup.inputs.slopes(source, value, interval)
        }
        _ => None,
    }
}
