//! Readings beside their predictions: deviations, and series of residuals in time.

use crate::control::problem::{Channel, Identification, Prior};
use crate::model::Quantity;
use nalgebra::DVector;

/// Part of the range of the values that the deviation of a channel is at least.
const LEAST: f64 = 1e-13;

/// All readings of some recordings.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Data {
    pub(super) values: DVector<f64>,
    /// Standard deviations; where they are not known, those of the last estimate.
    pub(super) deviations: DVector<f64>,
    relative: DVector<f64>,
    /// Group of each reading whose deviation is estimated: the readings of one quantity.
    groups: Vec<Option<usize>>,
    /// Range of the values of each group.
    ranges: Vec<f64>,
    /// Quantity of each group.
    kinds: Vec<Parts>,
    /// Deviation of each group.
    of_groups: Vec<f64>,
}

/// Quantity of a channel.
type Parts = Vec<(f64, Quantity)>;

/// Residuals of a channel of a recording in the order of time.
#[derive(Clone, Debug, PartialEq)]
pub struct Series {
    /// Index of the recording.
    pub recording: usize,
    /// Index of the channel.
    pub channel: usize,
    /// Times in ms.
    pub times: Vec<f64>,
    /// Measured values.
    pub measured: Vec<f64>,
    /// Predicted values.
    pub predicted: Vec<f64>,
    /// Standard deviations of the readings.
    pub deviations: Vec<f64>,
}

impl Series {
    /// Residuals in standard deviations.
    pub fn standardised(&self) -> Vec<f64> {
        let pairs = self.measured.iter().zip(&self.predicted);
        let all = pairs.zip(&self.deviations);
        all.map(|((measured, predicted), deviation)| (measured - predicted) / deviation)
            .collect()
    }
}

impl Data {
    /// The readings of the recordings `which`.
    pub(super) fn new(task: &Identification, which: &[usize]) -> Self {
        let (mut values, mut relative, mut groups) = (Vec::new(), Vec::new(), Vec::new());
        let mut kinds: Vec<Parts> = Vec::new();
        let mut ends: Vec<[f64; 2]> = Vec::new();
        for channel in which.iter().flat_map(|&r| &task.recordings[r].channels) {
            let group = (!channel.is_deviation_known).then(|| {
                let found = kinds.iter().position(|other| *other == channel.parts);
                found.unwrap_or_else(|| {
                    kinds.push(channel.parts.clone());
                    ends.push([f64::INFINITY, f64::NEG_INFINITY]);
                    kinds.len() - 1
                })
            });
            for reading in &channel.readings {
                values.push(reading.value);
                relative.push(reading.deviation);
                groups.push(group);
                if let Some([low, high]) = group.map(|g| &mut ends[g]) {
                    (*low, *high) = (low.min(reading.value), high.max(reading.value));
                }
            }
        }
        let size = |[low, high]: &[f64; 2]| (high - low).max(f64::MIN_POSITIVE);
        let mut out = Self {
            values: DVector::from_vec(values),
            deviations: DVector::zeros(relative.len()),
            relative: DVector::from_vec(relative),
            ranges: ends.iter().map(size).collect(),
            groups,
            kinds,
            of_groups: Vec::new(),
        };
        out.set(out.ranges.clone());
        out
    }

    /// The same with constants that are known beside them, as readings behind all others.
    pub(super) fn with_priors(mut self, priors: &[Prior]) -> Self {
        let count = self.values.len();
        let rows = count + priors.len();
        let behind = |vector: DVector<f64>, of: fn(&Prior) -> f64| {
            let mut vector = vector.resize_vertically(rows, 0.0);
            let places = vector.rows_mut(count, priors.len());
            (places.into_iter().zip(priors)).for_each(|(place, prior)| *place = of(prior));
            vector
        };
        self.values = behind(self.values, |prior| prior.value);
        self.relative = behind(self.relative, |prior| prior.deviation);
        self.deviations = behind(self.deviations, |prior| prior.deviation);
        self.groups.resize(rows, None);
        self
    }

    /// The deviation of a channel whose readings have this relative one; none where nothing tells it.
    pub(super) fn deviation(&self, channel: &Channel, relative: f64) -> Option<f64> {
        if channel.is_deviation_known {
            return Some(relative);
        }
        let group = self.kinds.iter().position(|kind| *kind == channel.parts)?;
        Some(relative * self.of_groups[group])
    }

    /// Takes the deviations that are not known from other data of the same quantities.
    pub(super) fn take(&mut self, other: &Self) {
        let same = |kind: &Parts| other.kinds.iter().position(|one| one == kind);
        let places: Vec<_> = self.kinds.iter().map(same).collect();
        let own = places.iter().zip(&self.of_groups);
        let taken = own.map(|(place, own)| place.map_or(*own, |p| other.of_groups[p]));
        let taken = taken.collect();
        self.set(taken);
    }

    /// Returns true if all standard deviations are known.
    pub(super) fn is_known(&self) -> bool {
        self.ranges.is_empty()
    }

    /// Least number of readings of a quantity of which the deviation is estimated beside others; none where none is, or one of all.
    pub(super) fn fewest(&self) -> Option<usize> {
        let count = |group: usize| self.groups.iter().filter(|g| **g == Some(group)).count();
        let counts = (0..self.ranges.len()).map(count);
        counts.min().filter(|_| !self.is_scaled_alike())
    }

    /// Returns true if one estimated deviation scales all readings, so that it does not change the fit.
    pub(super) fn is_scaled_alike(&self) -> bool {
        self.ranges.len() == 1 && self.groups.iter().all(Option::is_some)
    }

    fn set(&mut self, of_groups: Vec<f64>) {
        for (row, group) in self.groups.iter().enumerate() {
            self.deviations[row] = self.relative[row] * group.map_or(1.0, |g| of_groups[g]);
        }
        self.of_groups = of_groups;
    }

    /// Estimates the deviations of the groups from predictions with some number of unknowns.
    pub(super) fn estimate(&mut self, predicted: &DVector<f64>, unknowns: usize) {
        let mut sums = vec![[0.0; 2]; self.ranges.len()];
        for (row, group) in self.groups.iter().enumerate() {
            if let Some(group) = *group {
                let residual = (self.values[row] - predicted[row]) / self.relative[row];
                sums[group][0] += residual * residual;
                sums[group][1] += 1.0;
            }
        }
        // Each group loses its share of the unknowns.
        let all = self.values.len() as f64;
        let part = (all - unknowns as f64).max(1.0) / all;
        let sigma = |([sum, count], range): (&[f64; 2], &f64)| {
            (sum / (count * part)).sqrt().max(LEAST * range)
        };
        let of_groups = sums.iter().zip(&self.ranges).map(sigma).collect();
        self.set(of_groups);
    }

    /// The series of the recordings `which` beside predictions.
    pub(super) fn series(
        &self,
        task: &Identification,
        which: &[usize],
        predicted: &DVector<f64>,
    ) -> Vec<Series> {
        let mut row = 0;
        let mut out = Vec::new();
        for &recording in which {
            for (channel, of) in task.recordings[recording].channels.iter().enumerate() {
                let rows = row..row + of.readings.len();
                row = rows.end;
                out.push(Series {
                    recording,
                    channel,
                    times: of.readings.iter().map(|reading| reading.time).collect(),
                    measured: of.readings.iter().map(|reading| reading.value).collect(),
                    predicted: rows.clone().map(|r| predicted[r]).collect(),
                    deviations: rows.map(|r| self.deviations[r]).collect(),
                });
            }
        }
        out
    }
}
