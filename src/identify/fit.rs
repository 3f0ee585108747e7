//! Fit by weighted least squares: the method of Levenberg and Marquardt with bounds of the constants.
//!
//! A step d minimises `‖r − J d‖² + λ ‖D d‖²` over the unknowns that no bound holds, with residuals r and derivatives J in standard
//! deviations and the norms D of the columns of J; constants that leave their bounds are put on them. A constant on which hardly anything
//! depends is damped as one with a hundredth of the largest effect of a relative change, so that a step does not throw it away. The end is
//! a minimum where the squares fall along no unknown by more than a hundredth of its standard error.

use crate::control::problem::{Channel, Identification, Prior};
use crate::identify::error::IdentifyError;
use crate::identify::prediction::{Grid, Unknowns};
use crate::identify::readout::Prediction;
use crate::identify::setup::Problem;
use crate::model::{Parameter, Quantity};
use nalgebra::{DMatrix, DVector};

/// A step that is smaller than this part of the standard errors is the last one.
const SMALL: f64 = 1e-3;
/// A step that changes unknowns by less, relative to their sizes, is the last one.
const ROUNDING: f64 = 1e-8;
/// Most steps.
const MOST: usize = 100;
/// Part of the largest effect of a relative change of a constant that each is damped with at least.
const LEAST_EFFECT: f64 = 1e-2;
/// Slope by an unknown in its standard error, in units of the scatter, below which a point is a minimum.
const LEVEL: f64 = 1e-2;
/// Damping below which a step is that of least squares.
const UNDAMPED: f64 = 1e-2;
/// Damping λ of the first step, and where there is no descent.
const DAMPING: [f64; 2] = [1e-3, 1e10];
/// Most estimates of deviations that are not known, and the change that ends them.
const ESTIMATES: usize = 8;

/// Way in which a fit ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ended {
    /// At a minimum.
    Converged,
    /// After the most steps.
    Unfinished,
}

/// Constants and starts that fit recordings best.
#[derive(Clone, Debug, PartialEq)]
pub struct Fit {
    /// The unknowns.
    pub unknowns: Unknowns,
    /// Readings that they predict, with derivatives.
    pub prediction: Prediction,
    /// Way in which it ended.
    pub ended: Ended,
    /// Number of steps.
    pub steps: usize,
    /// True for constants that a bound holds.
    pub is_at_bound: Vec<bool>,
    pub(super) data: Data,
}

impl Fit {
    /// Residuals in standard deviations.
    pub fn residuals(&self) -> DVector<f64> {
        self.data.residuals(&self.prediction)
    }

    /// The constants.
    pub fn of_constants(&self) -> &[f64] {
        self.unknowns.of_constants()
    }

    /// Differences of the priors from the constants in standard deviations, in their order.
    pub fn of_priors(&self, task: &Identification) -> Vec<f64> {
        let all = self.residuals();
        let first = all.len() - task.priors.len();
        all.rows(first, task.priors.len()).iter().copied().collect()
    }

    /// Derivatives in standard deviations.
    pub(super) fn weighted(&self) -> DMatrix<f64> {
        self.data.weighted(&self.prediction)
    }

    /// Σ of the squared residuals.
    pub fn sum(&self) -> f64 {
        self.residuals().norm_squared()
    }

    /// Least number of readings from which the standard deviation of a quantity is estimated beside those of others.
    pub fn fewest(&self) -> Option<usize> {
        self.data.fewest()
    }

    /// Number of unknowns that no bound holds.
    pub fn free(&self) -> usize {
        self.unknowns.values.len() - self.is_at_bound.iter().filter(|held| **held).count()
    }

    /// Readings more than unknowns.
    pub fn freedom(&self) -> usize {
        self.data.values.len().saturating_sub(self.free())
    }
}

/// A fit that is under way.
struct Search<'a> {
    problem: Problem<'a>,
    which: &'a [usize],
    grid: &'a Grid,
    /// Constants that are known beside the recordings; none where constants stay.
    priors: &'a [Prior],
    /// Number of constants that stay as they are.
    held: usize,
}

impl Problem<'_> {
    /// Fits constants and starts to the recordings `which`, from the unknowns on; the first `held` constants stay.
    ///
    /// # Errors
    /// The recordings cannot be simulated at the unknowns.
    pub fn fit(
        self,
        which: &[usize],
        unknowns: Unknowns,
        held: usize,
        grid: &Grid,
    ) -> Result<Fit, IdentifyError> {
        let search = Search {
            problem: self,
            which,
            grid,
            priors: if held == 0 { &self.task.priors } else { &[] },
            held,
        };
        let mut data = Data::new(self.task, which).with_priors(search.priors);
        let mut found = search.minimise(unknowns, data.clone())?;
        if data.is_known() {
            return Ok(found);
        }
        data.estimate(&found.prediction.values, found.free());
        for _ in 1..ESTIMATES {
            if data.is_scaled_alike() {
                break;
            }
            let before = data.deviations.clone();
            found = search.minimise(found.unknowns, data.clone())?;
            data.estimate(&found.prediction.values, found.free());
            let change = (&data.deviations - &before).component_div(&before).amax();
            if change < 10.0 * SMALL {
                break;
            }
        }
        found.data = data;
        Ok(found)
    }
}

impl Search<'_> {
    /// The constant that an unknown is, where it is one.
    fn parameter(&self, unknown: usize) -> Option<&Parameter> {
        self.problem.task.parameters.get(unknown)
    }

    fn minimise(&self, mut unknowns: Unknowns, data: Data) -> Result<Fit, IdentifyError> {
        let at = |unknowns: &Unknowns| -> Result<Prediction, IdentifyError> {
            let of_recordings = self.problem.predict(self.which, unknowns, self.grid)?;
            Ok(of_recordings.with_priors(self.priors, unknowns.of_constants()))
        };
        let mut prediction = at(&unknowns)?;
        let cost = |prediction: &Prediction| data.residuals(prediction).norm_squared();
        let mut best = cost(&prediction);
        let [mut damping, none] = DAMPING;
        let (mut ended, mut steps) = (Ended::Unfinished, 0);
        'steps: while steps < MOST {
            steps += 1;
            let (jacobian, residuals) = (data.weighted(&prediction), data.residuals(&prediction));
            let free = self.free(&unknowns, &jacobian, &(jacobian.transpose() * &residuals));
            let norms = self.damping(&jacobian, &free);
            loop {
                let step = damped(&jacobian, &residuals, &norms, damping);
                let next = self.moved(&unknowns, &step);
                let moved = next.values.iter().zip(&unknowns.values);
                let moved = DVector::from_iterator(step.len(), moved.map(|(a, b)| a - b));
                let change = &jacobian * moved;
                let freedom = data.values.len().saturating_sub(free.len()).max(1);
                let scatter = match data.is_known() {
                    true => 1.0,
                    false => (best / freedom as f64).sqrt(),
                };
                let is_last =
                    change.norm() <= SMALL * scatter || self.is_rounding(&unknowns, &next);
                let tried = at(&next).ok().filter(|tried| cost(tried) < best);
                let is_better = tried.is_some();
                if let Some(better) = tried {
                    (unknowns, prediction) = (next, better);
                    best = cost(&prediction);
                    damping = (damping * 0.1).max(1e-12);
                }
                if is_last && damping <= UNDAMPED {
                    ended = Ended::Converged;
                    break 'steps;
                }
                if !is_better && damping > none {
                    break 'steps;
                }
                if is_better {
                    break;
                }
                damping *= 8.0;
            }
        }
        if self.is_minimum(&unknowns, &prediction, &data) {
            ended = Ended::Converged;
        }
        Ok(Fit {
            is_at_bound: self.at_bounds(&unknowns, &data.weighted(&prediction)),
            unknowns,
            prediction,
            ended,
            steps,
            data,
        })
    }

    /// Returns true if the squares fall along no unknown by more than a part of its standard error.
    fn is_minimum(&self, unknowns: &Unknowns, prediction: &Prediction, data: &Data) -> bool {
        let (jacobian, residuals) = (data.weighted(prediction), data.residuals(prediction));
        let descent = jacobian.transpose() * &residuals;
        let free = self.free(unknowns, &jacobian, &descent);
        let scatter = match data.is_known() {
            true => 1.0,
            false => {
                let freedom = data.values.len().saturating_sub(free.len()).max(1);
                residuals.norm() / (freedom as f64).sqrt()
            }
        };
        let mut slopes = free
            .iter()
            .map(|&j| descent[j].abs() / jacobian.column(j).norm());
        slopes.all(|slope| slope <= LEVEL * scatter)
    }

    /// Free unknowns with the norms D by which they are damped.
    fn damping(&self, jacobian: &DMatrix<f64>, free: &[usize]) -> Vec<(usize, f64)> {
        let norm = |j: usize| jacobian.column(j).norm();
        let size = |j: usize| self.parameter(j).map(Parameter::size);
        let effects = free
            .iter()
            .filter_map(|&j| size(j).map(|size| norm(j) * size));
        let least = LEAST_EFFECT * effects.fold(0.0, f64::max);
        let of = |&j: &usize| (j, norm(j).max(size(j).map_or(0.0, |size| least / size)));
        free.iter().map(of).collect()
    }

    /// Unknowns on which a reading depends and that no bound holds, where the squares fall along `descent`.
    fn free(
        &self,
        unknowns: &Unknowns,
        jacobian: &DMatrix<f64>,
        descent: &DVector<f64>,
    ) -> Vec<usize> {
        let is_free = |&j: &usize| match self.parameter(j) {
            Some(parameter) => {
                let value = unknowns.values[j];
                let at_lower = value <= parameter.lower && descent[j] < 0.0;
                let at_upper = value >= parameter.upper && descent[j] > 0.0;
                j >= self.held && !at_lower && !at_upper
            }
            None => true,
        };
        let all = (0..unknowns.values.len()).filter(|&j| jacobian.column(j).amax() > 0.0);
        all.filter(is_free).collect()
    }

    fn moved(&self, unknowns: &Unknowns, step: &DVector<f64>) -> Unknowns {
        let mut next = unknowns.clone();
        for (j, value) in next.values.iter_mut().enumerate() {
            *value += step[j];
            if let Some(parameter) = self.parameter(j) {
                *value = value.clamp(parameter.lower, parameter.upper);
            }
        }
        next
    }

    fn is_rounding(&self, unknowns: &Unknowns, next: &Unknowns) -> bool {
        let mut pairs = unknowns.values.iter().zip(&next.values).enumerate();
        pairs.all(|(j, (a, b))| {
            let size = self.parameter(j).map_or(0.0, Parameter::size);
            (a - b).abs() <= ROUNDING * a.abs().max(1e-3 * size)
        })
    }

    /// Constants at a bound, or nearer to one than a hundredth of the standard error that each would have alone.
    fn at_bounds(&self, unknowns: &Unknowns, jacobian: &DMatrix<f64>) -> Vec<bool> {
        let all = self.problem.task.parameters.iter().zip(&unknowns.values);
        all.enumerate()
            .map(|(j, (p, &value))| {
                let near = LEVEL / jacobian.column(j).norm();
                let near = if near.is_finite() { near } else { 0.0 };
                j >= self.held && (value <= p.lower + near || value >= p.upper - near)
            })
            .collect()
    }
}

/// The damped step over free unknowns with their norms D.
fn damped(
    jacobian: &DMatrix<f64>,
    residuals: &DVector<f64>,
    free: &[(usize, f64)],
    damping: f64,
) -> DVector<f64> {
    let (rows, count) = (jacobian.nrows(), free.len());
    let mut matrix = DMatrix::zeros(rows + count, count);
    let mut right = DVector::zeros(rows + count);
    right.rows_mut(0, rows).copy_from(residuals);
    for (column, &(j, norm)) in free.iter().enumerate() {
        let of = jacobian.column(j);
        matrix.view_mut((0, column), (rows, 1)).copy_from(&of);
        matrix[(rows + column, column)] = damping.sqrt() * norm;
    }
    let qr = matrix.qr();
    qr.q_tr_mul(&mut right);
    let solved = qr
        .r()
        .solve_upper_triangular(&right.rows(0, count).clone_owned());
    let mut step = DVector::zeros(jacobian.ncols());
    if let Some(solved) = solved {
        for (&(j, _), value) in free.iter().zip(solved.iter()) {
            step[j] = *value;
        }
    }
    step
}

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

    /// Residuals of a prediction in standard deviations.
    pub(super) fn residuals(&self, prediction: &Prediction) -> DVector<f64> {
        (&self.values - &prediction.values).component_div(&self.deviations)
    }

    /// Derivatives of a prediction in standard deviations.
    pub(super) fn weighted(&self, prediction: &Prediction) -> DMatrix<f64> {
        let mut out = prediction.derivatives.clone();
        for (mut row, deviation) in out.row_iter_mut().zip(self.deviations.iter()) {
            row /= *deviation;
        }
        out
    }

    /// Returns true if the deviation of a channel is known, or estimated with these data.
    pub(super) fn tells_deviation(&self, channel: &Channel) -> bool {
        channel.is_deviation_known || self.kinds.contains(&channel.parts)
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
        let of_groups = sums.iter().zip(&self.ranges);
        let of_groups = of_groups
            .map(|([sum, count], range)| (sum / (count * part)).sqrt().max(LEAST * range))
            .collect();
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
