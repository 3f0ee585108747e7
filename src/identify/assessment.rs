//! Checks of fitted constants, and experiments that could be done next.
//!
//! Prediction of recordings that no constant was fitted to.
//!
//! The differences r of n readings from their prediction have the covariance `Σ + S C Sᵀ`: that of the readings, and that of the
//! constants. Where the model explains them, `rᵀ (Σ + S C Sᵀ)⁻¹ r` has the χ² distribution of n degrees of freedom; where Σ is
//! estimated from the fit, a part n of it has that of Fisher and Snedecor. Unknown starts are fitted, and take their number from n.
//!
//! Whiteness of residuals: the test of Ljung and Box.
//!
//! `Q = n (n + 2) Σ_{k=1..L} ρ_k²/(n − k)` of the autocorrelations ρ of n residuals has the χ² distribution of L degrees of freedom where they
//! are independent.
//!
//! Squares of residuals at the ends of intervals, against those that derivatives foretell.
//!
//! Half an interval of a constant follows from the derivatives J at the estimate. Its end belongs to a change δ of all unknowns, of which the
//! others make up for that of the constant as far as they can. Where the predictions f are straight, the sum of the squared residuals r rises
//! by ‖J δ‖² there; where it rises otherwise, the data allow another interval.

use crate::control::problem::{Identification, Recording};
use crate::identify::error::IdentifyError;
use crate::identify::fit::{Data, Fit, Series};
use crate::identify::information::Information;
use crate::identify::prediction::{Grid, Unknowns};
use crate::identify::setup::Problem;
use crate::stop;
use nalgebra::{DMatrix, DVector};
use statrs::distribution::{ChiSquared, ContinuousCDF, FisherSnedecor};

/// Probability below which a prediction does not explain a recording.
pub(super) const LEVEL: f64 = 0.01;

/// Root of the mean squared change by halved steps, in standard deviations, below which predictions have no bias by the grid.
const CHANGE: f64 = 0.1;
/// Most halvings of the steps for it.
const HALVINGS: usize = 6;

/// A recording that was held out, and its prediction.
#[derive(Clone, Debug, PartialEq)]
pub struct HeldOut {
    /// Index of the recording.
    pub recording: usize,
    /// Its residuals.
    pub series: Vec<Series>,
    /// Σ of the squared residuals in standard deviations of the readings alone over their number.
    pub reduced: f64,
    /// `rᵀ (Σ + S C Sᵀ)⁻¹ r` over n: 1 where all is as expected.
    pub statistic: f64,
    /// The value that the statistic exceeds with a probability of 1 %.
    pub quantile: f64,
    /// Probability of so large a statistic.
    pub p: f64,
    /// Whiteness of the residuals of each channel.
    pub whiteness: Vec<Option<Whiteness>>,
    /// Intervals of the coarser of the two grids on which it is predicted.
    pub(super) intervals: usize,
    /// Unknowns of its start.
    pub(super) start: Vec<f64>,
}

impl HeldOut {
    /// Returns true if its readings do not differ from the prediction by more than chance.
    pub fn is_explained(&self) -> bool {
        self.p >= LEVEL && self.not_white().next().is_none()
    }

    /// The channels whose differences are not white, with the probability of what was found; together they are as improbable as a large statistic.
    pub fn not_white(&self) -> impl Iterator<Item = (usize, f64)> + '_ {
        let count = self.whiteness.iter().flatten().count().max(1) as f64;
        let tests = self.series.iter().zip(&self.whiteness);
        tests.filter_map(move |(series, test)| {
            let p = test.as_ref()?.p;
            (p < LEVEL / count).then_some((series.channel, p))
        })
    }

    /// The prediction of a recording by a fit.
    pub(super) fn new(
        problem: Problem<'_>,
        recording: usize,
        of: &Fit,
        information: &Information,
        grid: &Grid,
    ) -> Result<Self, IdentifyError> {
        let task = problem.task;
        let mut unknowns = Unknowns::new(task, |_| 0);
        let constants = of.unknowns.of_constants();
        unknowns.values[..constants.len()].copy_from_slice(constants);
        let first = unknowns.values.len();
        let count = problem.count_of_start(&task.recordings[recording])?;
        unknowns.values.resize(first + count, 0.0);
        unknowns.starts[recording] = first..first + count;
        let which = [recording];
        let mut data = Data::new(task, &which);
        let others = "that constants are fitted to";
        check_deviations(&task.recordings[recording], &of.data, others)?;
        data.take(&of.data);
        let on = |grid: &Grid| problem.fit(&which, unknowns.clone(), constants.len(), grid);
        let (mut grid, mut found) = (grid.clone(), on(grid)?);
        // Its own steps may have to be shorter than those of the fit.
        for _ in 0..HALVINGS {
            grid = grid.halved();
            let finer = on(&grid)?;
            let change = &finer.prediction.values - &found.prediction.values;
            let change = change.component_div(&data.deviations).norm();
            found = finer;
            if change < CHANGE * (data.values.len() as f64).sqrt() {
                break;
            }
        }
        let whole = data.weighted(&found.prediction);
        let mut residuals = data.residuals(&found.prediction);
        let n = (residuals.len() - count) as f64;
        let series = data.series(task, &which, &found.prediction.values);
        let reduced = residuals.norm_squared() / n;
        let mut by = whole.columns(0, constants.len()).into_owned();
        remove(
            &whole.columns(constants.len(), count).into_owned(),
            &mut by,
            &mut residuals,
        );
        let residuals = whitened(&by, &information.covariance, &residuals);
        let statistic = residuals.norm_squared() / n;
        let (p, quantile) = match of.data.is_known() {
            true => {
                let chi = ChiSquared::new(n).expect("a positive number");
                (chi.sf(statistic * n), chi.inverse_cdf(1.0 - LEVEL) / n)
            }
            false => {
                let freedom = of.freedom().max(1) as f64;
                let f = FisherSnedecor::new(n, freedom).expect("positive numbers");
                (f.sf(statistic), f.inverse_cdf(1.0 - LEVEL))
            }
        };
        Ok(Self {
            recording,
            whiteness: whiteness(&series, &residuals),
            series,
            reduced,
            statistic,
            quantile,
            p,
            intervals: grid.intervals[recording],
            start: found.unknowns.of_start(recording).to_vec(),
        })
    }
}

/// Removes what changes of the start make up for.
fn remove(starts: &DMatrix<f64>, by: &mut DMatrix<f64>, residuals: &mut DVector<f64>) {
    if starts.ncols() == 0 {
        return;
    }
    let q = starts.clone().qr().q();
    *by -= &q * (q.transpose() * &*by);
    *residuals -= &q * (q.transpose() * &*residuals);
}

/// Whiteness of residuals that follow one another as their series do.
fn whiteness(series: &[Series], residuals: &DVector<f64>) -> Vec<Option<Whiteness>> {
    let mut first = 0;
    let of = |one: &Series| {
        let rows = residuals.rows(first, one.times.len());
        first += one.times.len();
        ljung_box(rows.as_slice())
    };
    series.iter().map(of).collect()
}

/// `(1 + S C Sᵀ)^−½ r`, which are independent where the model explains the readings, by the root of C: with the singular values σ and left
/// vectors U of `B = S C^½` it is `r − U (1 − 1/√(1 + σ²)) Uᵀ r`.
fn whitened(
    by: &DMatrix<f64>,
    covariance: &DMatrix<f64>,
    residuals: &DVector<f64>,
) -> DVector<f64> {
    // In units in which the variances are 1.
    let sizes = covariance
        .diagonal()
        .map(|v| if v > 0.0 { v.sqrt() } else { 1.0 });
    let scaled = DMatrix::from_fn(sizes.len(), sizes.len(), |i, j| {
        covariance[(i, j)] / (sizes[i] * sizes[j])
    });
    let eigen = scaled.symmetric_eigen();
    let roots = eigen.eigenvalues.map(|value| value.max(0.0).sqrt());
    let root = DMatrix::from_diagonal(&sizes) * eigen.eigenvectors * DMatrix::from_diagonal(&roots);
    let svd = (by * root).svd(true, false);
    let u = svd.u.expect("asked for");
    let parts = u.transpose() * residuals;
    let parts = parts.iter().zip(svd.singular_values.iter());
    let parts = parts.map(|(part, s)| part * (1.0 - (1.0 + s * s).sqrt().recip()));
    residuals - &u * DVector::from_iterator(u.ncols(), parts)
}

/// Most lags L; of short series a fifth of their length.
const MOST: usize = 10;
/// Fewest residuals that tell anything.
const FEWEST: usize = 10;

/// Result of the test.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Whiteness {
    /// Q.
    pub statistic: f64,
    /// Lags L.
    pub lags: usize,
    /// Probability of so large a Q where residuals are independent.
    pub p: f64,
    /// Autocorrelation of neighbours.
    pub neighbours: f64,
}

/// The test of a series of residuals about zero in the order of time; none of too short a series.
pub fn ljung_box(residuals: &[f64]) -> Option<Whiteness> {
    let n = residuals.len();
    let lags = MOST.min(n / 5);
    let square: f64 = residuals.iter().map(|r| r * r).sum();
    if n < FEWEST || square <= 0.0 {
        return None;
    }
    let correlation = |k: usize| {
        let products = residuals[k..].iter().zip(residuals);
        products.map(|(a, b)| a * b).sum::<f64>() / square
    };
    let size = n as f64;
    let part = |k: usize| correlation(k).powi(2) / (size - k as f64);
    let statistic = size * (size + 2.0) * (1..=lags).map(part).sum::<f64>();
    let distribution = ChiSquared::new(lags as f64).ok()?;
    Some(Whiteness {
        statistic,
        lags,
        p: distribution.sf(statistic),
        neighbours: correlation(1),
    })
}

/// Part of half an interval that has to lie within the bounds.
const INSIDE: f64 = 0.5;
/// Rises over those foretold, of an interval of about the right length.
const ALIKE: [f64; 2] = [0.6, 1.7];
/// Singular value of the derivatives, relative to the largest, of a combination that the others can make up for.
const RANK: f64 = 1e-8;

/// Rises at both ends of the interval of each constant over those foretold; none where bounds cut the interval, or there is none.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Rises(pub Vec<[Option<f64>; 2]>);

impl Rises {
    /// Those of a fit, by predictions on a grid.
    ///
    /// # Errors
    /// The recordings cannot be simulated at the estimate.
    pub(super) fn new(
        problem: Problem<'_>,
        fitted: &[usize],
        found: &Fit,
        information: &Information,
        grid: &Grid,
    ) -> Result<Self, IdentifyError> {
        let task = problem.task;
        let jacobian = found.weighted();
        let residuals = found.residuals();
        let predicted = |values: &[f64]| {
            let mut unknowns = found.unknowns.clone();
            unknowns.values.copy_from_slice(values);
            let own = problem.predict(fitted, &unknowns, grid)?;
            let own = own.with_priors(&task.priors, unknowns.of_constants());
            Ok::<_, IdentifyError>(own.values)
        };
        let estimate = &found.unknowns.values;
        let here = predicted(estimate)?;
        let mut out = Vec::new();
        for j in 0..task.parameters.len() {
            let half = information.half(j);
            let is_known = information.is_determined[j] && half > 0.0;
            if !is_known || stop::reason().is_some() {
                out.push([None; 2]);
                continue;
            }
            let change = end(&jacobian, found, j) * half;
            let foretold = (&jacobian * &change).norm_squared();
            out.push([-1.0, 1.0].map(|side| {
                let part = inside(task, estimate, &change, side);
                let moved = estimate.iter().zip(change.iter());
                let moved: Vec<f64> = moved.map(|(x, d)| x + side * part * d).collect();
                (part >= INSIDE).then(|| match predicted(&moved) {
                    Ok(there) => {
                        let change = (there - &here).component_div(&found.data.deviations);
                        let rise = (&residuals - change).norm_squared() - residuals.norm_squared();
                        rise / (part * part * foretold)
                    }
                    Err(_) => f64::INFINITY,
                })
            }));
        }
        Ok(Self(out))
    }

    /// Constants of which an interval is not confirmed, with the rises at its ends.
    pub fn unlike(&self) -> impl Iterator<Item = (usize, [Option<f64>; 2])> + '_ {
        let [least, most] = ALIKE;
        let is_unlike = move |rise: &f64| !(least..=most).contains(rise);
        let all = self.0.iter().copied().enumerate();
        all.filter(move |(_, ends)| ends.iter().flatten().any(is_unlike))
    }
}

/// Change of all unknowns by which constant `j` grows by one, and others make up for it.
fn end(jacobian: &DMatrix<f64>, found: &Fit, j: usize) -> DVector<f64> {
    let is_open = |&i: &usize| {
        let is_held = found.is_at_bound.get(i).copied().unwrap_or(false);
        i != j && !is_held && jacobian.column(i).amax() > 0.0
    };
    let others: Vec<usize> = (0..jacobian.ncols()).filter(is_open).collect();
    let mut out = DVector::zeros(jacobian.ncols());
    out[j] = 1.0;
    if others.is_empty() {
        return out;
    }
    let scaled = DMatrix::from_fn(jacobian.nrows(), others.len(), |row, i| {
        jacobian[(row, others[i])] / jacobian.column(others[i]).norm()
    });
    let svd = scaled.svd(true, true);
    let least = RANK * svd.singular_values.amax();
    let made_up = svd.solve(&jacobian.column(j), least);
    let made_up = made_up.expect("both sets of vectors were asked for");
    for (&i, by) in others.iter().zip(made_up.iter()) {
        out[i] = -by / jacobian.column(i).norm();
    }
    out
}

/// Greatest part of a change, at most all of it, by which constants stay within their bounds.
fn inside(task: &Identification, values: &[f64], change: &DVector<f64>, side: f64) -> f64 {
    let pairs = task.parameters.iter().zip(values).zip(change.iter());
    let parts = pairs.map(|((parameter, value), by)| {
        let by = side * by;
        let bound = if by < 0.0 {
            parameter.lower
        } else {
            parameter.upper
        };
        match by == 0.0 {
            true => 1.0,
            false => (bound - value) / by,
        }
    });
    parts.fold(1.0, f64::min)
}

/// A candidate, and the information on the constants with its readings.
#[derive(Clone, Debug, PartialEq)]
pub struct Experiment {
    /// Index of the candidate.
    pub candidate: usize,
    /// The information after it.
    pub information: Information,
}

impl Experiment {
    /// All candidates, the best one first: that which leaves fewest combinations undetermined, then the lowest sum of the relative variances.
    pub(super) fn all(
        problem: Problem<'_>,
        fit: &Fit,
        halvings: usize,
    ) -> Result<Vec<Self>, IdentifyError> {
        let of = |candidate| {
            Self::new(problem, candidate, fit, halvings).map_err(IdentifyError::of_candidate)
        };
        let all: Result<Vec<_>, _> = (0..problem.task.candidates.len()).map(of).collect();
        let mut all = all?;
        all.sort_by(|a, b| a.rank().partial_cmp(&b.rank()).expect("numbers"));
        Ok(all)
    }

    fn rank(&self) -> (usize, f64) {
        let open = &self.information.undetermined;
        let infinite = open
            .iter()
            .filter(|one| one.deviation.is_infinite())
            .count();
        (infinite, self.information.finite_variance)
    }

    fn new(
        problem: Problem<'_>,
        candidate: usize,
        fit: &Fit,
        halvings: usize,
    ) -> Result<Self, IdentifyError> {
        let task = problem.task;
        let recording = &task.candidates[candidate];
        let alone = Identification {
            recordings: vec![recording.clone()],
            ..task.clone()
        };
        let count = problem.count_of_start(recording)?;
        let mut unknowns = Unknowns::new(&alone, |_| count);
        let constants = unknowns.constants;
        unknowns.values[..constants].copy_from_slice(fit.unknowns.of_constants());
        let mut grid = Grid::first(&alone, &alone.recordings);
        for _ in 0..halvings {
            grid = grid.halved();
        }
        let one = Problem {
            task: &alone,
            ..problem
        };
        let mut data = Data::new(&alone, &[0]);
        data.take(&fit.data);
        let added = data.weighted(&one.predict(&[0], &unknowns, &grid)?);
        let before = fit.weighted();
        let (rows, columns) = before.shape();
        let mut whole = before.resize(rows + added.nrows(), columns + count, 0.0);
        let mut below = whole.rows_mut(rows, added.nrows());
        below
            .columns_mut(0, constants)
            .copy_from(&added.columns(0, constants));
        below
            .columns_mut(columns, count)
            .copy_from(&added.columns(constants, count));
        let freedom = (!fit.data.is_known()).then(|| fit.freedom() + added.nrows() - count);
        let values = fit.unknowns.of_constants();
        Ok(Self {
            candidate,
            information: Information::new(task, &whole, values, &fit.is_at_bound, freedom),
        })
    }
}

/// Refuses a recording with readings whose standard deviation is neither known nor estimated from these data, of recordings in words.
pub(super) fn check_deviations(
    recording: &Recording,
    data: &Data,
    others: &str,
) -> Result<(), IdentifyError> {
    let mut channels = recording.channels.iter();
    let unknown = channels.find(|channel| !data.tells_deviation(channel));
    unknown.map_or(Ok(()), |channel| Err(recording.refused(format!(
        "nothing tells the standard deviation of {}, which no recording measures {others}; expected one",
        channel.name
    ))))
}
