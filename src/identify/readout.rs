//! Channels read off a motion, with their derivatives by the unknowns.

use crate::control::problem::{Channel, Reading};
use crate::coordinates::Configuration;
use crate::dynamics::DiscreteTrajectory;
use crate::functional::{Measure, Sample, SumDerivatives};
use crate::identify::interpolation::weights;
use crate::model::{Model, Quantity};
use nalgebra::{DMatrix, DVector, RowDVector};

/// A motion with its derivatives by the unknowns at each instant.
#[derive(Clone, Copy, Debug)]
pub(super) struct Course<'a> {
    pub(super) model: &'a Model,
    pub(super) discrete: &'a DiscreteTrajectory,
    pub(super) derivatives: &'a [DMatrix<f64>],
}

/// Values and derivatives of readings.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Values {
    /// Value of each reading.
    pub values: DVector<f64>,
    /// Row of derivatives of each reading.
    pub derivatives: DMatrix<f64>,
}

/// Storage of the evaluation of measures.
struct Scratch {
    part: SumDerivatives,
    rows: Vec<f64>,
}

impl Course<'_> {
    /// All channels at their readings.
    pub(super) fn read(&self, channels: &[Channel], columns: usize) -> Values {
        let count: usize = channels.iter().map(|one| one.readings.len()).sum();
        let mut out = Values {
            values: DVector::zeros(count),
            derivatives: DMatrix::zeros(count, columns),
        };
        let instants: Vec<Configuration> = self.placed();
        let (mut row, mut index) = (0, 0);
        for channel in channels {
            for (factor, quantity) in &channel.parts {
                let nodes = self.nodes(&instants, (index, quantity), columns);
                index += 1;
                let readings = channel.readings.iter().enumerate();
                readings.for_each(|(k, reading)| {
                    self.interpolate(quantity, &nodes, reading, (*factor, row + k), &mut out);
                });
            }
            row += channel.readings.len();
        }
        out
    }

    fn placed(&self) -> Vec<Configuration> {
        let map = &self.model.action.map;
        self.discrete.z.iter().map(|z| map.placed(z)).collect()
    }

    /// Times from which and between which values are known.
    fn grid(&self, quantity: &Quantity) -> [f64; 2] {
        let h = self.discrete.times[1] - self.discrete.times[0];
        match quantity.is_of_intervals() {
            true => [0.5 * h, h],
            false => [0.0, h],
        }
    }

    fn interpolate(
        &self,
        quantity: &Quantity,
        (values, derivatives): &(Vec<f64>, Vec<RowDVector<f64>>),
        reading: &Reading,
        (factor, row): (f64, usize),
        out: &mut Values,
    ) {
        let (begin, weights) = weights(reading.time, self.grid(quantity), values.len());
        for (j, weight) in weights.iter().enumerate() {
            out.values[row] += factor * weight * values[begin + j];
            let mut into = out.derivatives.row_mut(row);
            into += &derivatives[begin + j] * (factor * weight);
        }
    }

    /// Values of a quantity at all instants or in all intervals, and their derivatives.
    fn nodes(
        &self,
        instants: &[Configuration],
        (index, quantity): (usize, &Quantity),
        columns: usize,
    ) -> (Vec<f64>, Vec<RowDVector<f64>>) {
        let sides = 1 + usize::from(quantity.is_of_intervals());
        let count = instants.len() + 1 - sides;
        let Some(place) = self.model.measured[index] else {
            return (vec![0.0; count], vec![RowDVector::zeros(columns); count]);
        };
        let sum = match sides {
            1 => &self.model.action.instants,
            _ => &self.model.action.intervals,
        };
        let measure = sum.measures[place].as_ref();
        let [_, h] = self.grid(quantity);
        let factor = if sides == 1 { 1.0 } else { 1.0 / h };
        let map = &self.model.action.map;
        let mut scratch = Scratch {
            part: SumDerivatives::new(
                map.vectors.len(),
                self.model.action.layout().interval_scalars,
                None,
            ),
            rows: vec![0.0; map.unknowns()],
        };
        let (mut values, mut derivatives) = (Vec::new(), Vec::new());
        for k in 0..count {
            let here = [&instants[k], &instants[k + sides - 1]];
            let scalars = self.discrete.scalars.get(k).map_or(&[][..], Vec::as_slice);
            let sample = Sample {
                vectors: here.map(|instant| &instant.x[..]),
                h,
                ..Sample::of_instant(&here[0].x, scalars)
            };
            values.push(factor * measure.value(&sample));
            let mut row = RowDVector::zeros(columns);
            self.differentiate(measure, (&sample, here), k, (&mut scratch, &mut row));
            derivatives.push(row * factor);
        }
        if let Some(period) = quantity.period(&self.model.system) {
            unwrap(&mut values, period);
        }
        (values, derivatives)
    }

    /// Adds the derivatives of a measure at instant or interval k.
    fn differentiate(
        &self,
        measure: &dyn Measure,
        (sample, here): (&Sample<'_>, [&Configuration; 2]),
        k: usize,
        (scratch, out): (&mut Scratch, &mut RowDVector<f64>),
    ) {
        let map = &self.model.action.map;
        let part = &mut scratch.part;
        measure.gradient(sample, &mut part.forces, &mut part.rows);
        let mut vectors = measure.vectors();
        vectors.sort_unstable();
        vectors.dedup();
        for side in (0..2).filter(|&side| measure.reads(side)) {
            scratch.rows.fill(0.0);
            for &vector in &vectors {
                let force = std::mem::take(&mut part.forces[side][vector]);
                map.pull_back_one(vector, &here[side].columns, &force, &mut scratch.rows);
            }
            let by = &self.derivatives[k + side];
            for (i, force) in scratch.rows[..by.nrows()].iter().enumerate() {
                if *force != 0.0 {
                    *out += by.row(i) * *force;
                }
            }
        }
        part.rows.fill(0.0);
    }
}

/// Makes values continue without jumps by a period.
fn unwrap(values: &mut [f64], period: f64) {
    for k in 1..values.len() {
        let turns = ((values[k - 1] - values[k]) / period).round();
        values[k] += turns * period;
    }
}
