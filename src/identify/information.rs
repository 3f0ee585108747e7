//! Information of data on the constants: covariance, intervals, correlations, and combinations that are not determined.
//!
//! Unknown starts are eliminated: the derivatives by constants lose their parts that changes of starts make up for. The singular values s
//! of what remains, by relative changes of the constants, are the reciprocal standard deviations of combinations of their logarithms.

use crate::control::problem::Identification;
use crate::identify::fit::Fit;
use nalgebra::{DMatrix, DVector};
use statrs::distribution::{ContinuousCDF, FisherSnedecor, Normal, StudentsT};

/// Singular values below this part of the largest are round-off.
const ROUND_OFF: f64 = 1e-7;
/// Probability of the intervals.
pub(super) const PROBABILITY: f64 = 0.95;
/// Part of a constant in a combination that is not determined, below which the constant is.
const PART: f64 = 0.02;

/// A combination of constants that the data do not determine.
#[derive(Clone, Debug, PartialEq)]
pub struct Undetermined {
    /// Powers of the constants, of which the largest is 1: along `θ_j → θ_j s^{power_j}` for all j nothing changes.
    pub powers: Vec<(usize, f64)>,
    /// Relative standard deviation of a change along it; infinite where nothing changes at all.
    pub deviation: f64,
    /// The product that is determined, where only one combination of these constants is not.
    pub determined: Option<Product>,
}

/// A product of powers of constants that the data determine.
#[derive(Clone, Debug, PartialEq)]
pub struct Product {
    /// Powers of the constants.
    pub powers: Vec<(usize, f64)>,
    /// Its value, by the units of the constants.
    pub value: f64,
    /// Its relative standard deviation.
    pub deviation: f64,
}

/// Information of a fit on the constants.
#[derive(Clone, Debug, PartialEq)]
pub struct Information {
    /// Covariance of the constants in the squares of their units; zero of those at bounds or not determined.
    pub covariance: DMatrix<f64>,
    /// True for constants that the data determine.
    pub is_determined: Vec<bool>,
    /// Combinations that they do not determine.
    pub undetermined: Vec<Undetermined>,
    /// Factor from standard deviations to halves of the intervals of 95 %.
    pub factor: f64,
    /// Square of the half axes of the ellipsoid of 95 % in standard deviations.
    pub ellipsoid: f64,
    /// Σ of the relative variances of the constants, without combinations along which nothing changes at all.
    pub finite_variance: f64,
}

impl Information {
    /// Half the interval of 95 % of a constant.
    pub fn half(&self, constant: usize) -> f64 {
        self.factor * self.covariance[(constant, constant)].sqrt()
    }

    /// Correlation of two constants.
    pub fn correlation(&self, a: usize, b: usize) -> f64 {
        let variance = |j: usize| self.covariance[(j, j)];
        self.covariance[(a, b)] / (variance(a) * variance(b)).sqrt()
    }

    /// The information of a fit; degrees of freedom are none where the standard deviations are known.
    pub(super) fn of_fit(task: &Identification, fit: &Fit) -> Self {
        let freedom = (!fit.data.is_known()).then(|| fit.freedom().max(1));
        let values = fit.unknowns.of_constants();
        Self::new(task, (&fit.weighted(), values), &fit.is_at_bound, freedom)
    }

    /// The information of derivatives in standard deviations.
    pub(super) fn new(
        task: &Identification,
        (weighted, values): (&DMatrix<f64>, &[f64]),
        is_held: &[bool],
        freedom: Option<usize>,
    ) -> Self {
        let constants = values.len();
        let scales = scales(task, values);
        // A bound tells nothing of the data: what they determine is asked of all constants.
        let free: Vec<usize> = (0..constants).collect();
        let inside = is_held.iter().filter(|held| !**held).count();
        let mut own = DMatrix::zeros(weighted.nrows(), free.len());
        for (column, &j) in free.iter().enumerate() {
            own.set_column(column, &(weighted.column(j) * scales[j]));
        }
        let starts = weighted.columns(constants, weighted.ncols() - constants);
        let (factor, ellipsoid) = quantiles(inside, freedom);
        let [singular, directions] = without(own, &starts.into_owned());
        let largest = singular.amax();
        let deviation = |k: usize| match singular[k] <= ROUND_OFF * largest {
            true => f64::INFINITY,
            false => singular[k].recip(),
        };
        let (is_open, is_known): (Vec<usize>, Vec<usize>) =
            (0..free.len()).partition(|&k| factor * deviation(k) >= 1.0);
        let finite = (0..free.len()).map(deviation).filter(|d| d.is_finite());
        let mut out = Self {
            covariance: DMatrix::zeros(constants, constants),
            is_determined: vec![true; constants],
            undetermined: Vec::new(),
            factor,
            ellipsoid,
            finite_variance: finite.map(|d: f64| d * d).sum(),
        };
        let part = |j: usize, k: usize| directions[(j, k)];
        for (column, &j) in free.iter().enumerate() {
            out.is_determined[j] = is_open.iter().all(|&k| part(column, k).abs() < PART);
        }
        for (a, &i) in free.iter().enumerate() {
            for (b, &j) in free.iter().enumerate() {
                let is_inside = !is_held[i] && !is_held[j];
                if is_inside && out.is_determined[i] && out.is_determined[j] {
                    let of = |&k: &usize| part(a, k) * part(b, k) * deviation(k).powi(2);
                    let sum: f64 = is_known.iter().map(of).sum();
                    out.covariance[(i, j)] = sum * scales[i] * scales[j];
                }
            }
        }
        for &k in &is_open {
            let powers = directions.column(k).into_owned();
            out.undetermined.push(Undetermined {
                powers: named(&powers, &free),
                deviation: deviation(k),
                determined: None,
            });
        }
        if let [only] = &mut out.undetermined[..] {
            let known = (&directions, &is_known[..]);
            only.determined = product(only, (&free, values), known, deviation);
        }
        out
    }
}

impl Fit {
    /// Returns its information on the constants.
    pub fn information(&self, task: &Identification) -> Information {
        Information::of_fit(task, self)
    }
}

/// Sizes of the constants: themselves where they are positive, otherwise the distance of their bounds.
fn scales(task: &Identification, values: &[f64]) -> Vec<f64> {
    let scale = |(parameter, value): (&crate::model::Parameter, &f64)| match parameter.lower > 0.0 {
        true => *value,
        false => match parameter.upper - parameter.lower {
            width if width.is_finite() => width,
            _ => value.abs().max(parameter.size()),
        },
    };
    task.parameters.iter().zip(values).map(scale).collect()
}

/// Factor of intervals and square of the ellipsoid.
fn quantiles(constants: usize, freedom: Option<usize>) -> (f64, f64) {
    let two_sided = 0.5 + 0.5 * PROBABILITY;
    let count = constants.max(1) as f64;
    match freedom {
        Some(freedom) => {
            let freedom = freedom as f64;
            let t = StudentsT::new(0.0, 1.0, freedom).expect("a positive number");
            let f = FisherSnedecor::new(count, freedom).expect("positive numbers");
            (t.inverse_cdf(two_sided), count * f.inverse_cdf(PROBABILITY))
        }
        None => {
            let chi = statrs::distribution::ChiSquared::new(count).expect("a positive number");
            (
                Normal::standard().inverse_cdf(two_sided),
                chi.inverse_cdf(PROBABILITY),
            )
        }
    }
}

/// Singular values and right directions of columns without what other columns make up for, by falling singular values.
fn without(own: DMatrix<f64>, starts: &DMatrix<f64>) -> [DMatrix<f64>; 2] {
    let count = own.ncols();
    let mut rest = own;
    if starts.ncols() > 0 && starts.amax() > 0.0 {
        let mut scaled = starts.clone();
        for mut column in scaled.column_iter_mut() {
            let norm = column.norm();
            if norm > 0.0 {
                column /= norm;
            }
        }
        let svd = scaled.svd(true, false);
        let u = svd.u.expect("asked for");
        for (k, value) in svd.singular_values.iter().enumerate() {
            if *value > ROUND_OFF * svd.singular_values[0] {
                let direction = u.column(k).into_owned();
                let parts = direction.transpose() * &rest;
                rest -= direction * parts;
            }
        }
    }
    // Fewer rows than columns leave directions without a singular value.
    let rows = rest.nrows().max(count);
    let rest = rest.resize_vertically(rows, 0.0);
    let svd = rest.qr().r().svd(false, true);
    let v = svd.v_t.expect("asked for").transpose();
    [
        DMatrix::from_column_slice(count, 1, svd.singular_values.as_slice()),
        v,
    ]
}

/// The powers of constants in a direction, of which the largest is 1.
fn named(direction: &DVector<f64>, free: &[usize]) -> Vec<(usize, f64)> {
    let largest = direction
        .iter()
        .copied()
        .fold(0.0, |a: f64, b: f64| match b.abs() > a.abs() {
            true => b,
            false => a,
        });
    let powers = free.iter().zip(direction.iter());
    let powers = powers.map(|(&j, power)| (j, power / largest));
    powers.filter(|(_, power)| power.abs() >= PART).collect()
}

/// The product of two constants that is determined where only one combination of them is not.
fn product(
    open: &Undetermined,
    (free, values): (&[usize], &[f64]),
    (directions, known): (&DMatrix<f64>, &[usize]),
    deviation: impl Fn(usize) -> f64,
) -> Option<Product> {
    let [(a, p), (b, q)] = open.powers[..] else {
        return None;
    };
    // Across the direction, with a first power of one.
    let powers = vec![(a, 1.0), (b, -p / q)];
    let value = powers
        .iter()
        .map(|&(j, power)| values[j].powf(power))
        .product();
    let place = |j: usize| free.iter().position(|&other| other == j);
    let (i, j) = (place(a)?, place(b)?);
    let of = |&k: &usize| {
        let change = directions[(i, k)] - p / q * directions[(j, k)];
        (change * deviation(k)).powi(2)
    };
    let variance: f64 = known.iter().map(of).sum();
    Some(Product {
        powers,
        value,
        deviation: variance.sqrt(),
    })
}
