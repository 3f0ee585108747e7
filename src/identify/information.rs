//! Information of data on the constants: covariance, intervals, correlations, and combinations that are not determined.
//!
//! Unknown starts are eliminated: the derivatives by constants lose their parts that changes of starts make up for. The singular values s
//! of what remains, by relative changes of the constants, are the reciprocal standard deviations of combinations of their logarithms.

use crate::control::problem::Identification;
use crate::identify::fit::Fit;
use crate::model::Parameter;
use nalgebra::{DMatrix, DVector};
use statrs::distribution::{ContinuousCDF, FisherSnedecor, Normal, StudentsT};

/// Singular values below this part of the largest are round-off.
const ROUND_OFF: f64 = 1e-7;
/// Probability of the intervals.
pub(super) const PROBABILITY: f64 = 0.95;
/// Part of a constant in a combination that is not determined, below which it is not named with it.
const PART: f64 = 0.02;
/// Variance of a constant, relative to that which is left where others are known, beyond which these decide its value.
const BY_OTHERS: f64 = 10.0;

/// A combination of constants that the data do not determine.
#[derive(Clone, Debug, PartialEq)]
pub struct Undetermined {
    /// Powers of the constants, of which the largest is 1: along `θ_j → θ_j s^{power_j}` for all j nothing changes.
    pub powers: Vec<(usize, f64)>,
    /// Those of them that are not determined.
    pub constants: Vec<usize>,
    /// Relative standard deviation of a change along it; infinite where nothing changes at all.
    pub deviation: f64,
    /// The combination that is determined of two constants, where only one combination of them is not.
    pub determined: Option<Product>,
}

/// A combination of two constants that the data determine: the sum of the factors times relative changes, which is the logarithm of a product of powers.
#[derive(Clone, Debug, PartialEq)]
pub struct Product {
    /// Factors of the relative changes, the first and largest one 1.
    pub powers: Vec<(usize, f64)>,
    /// The product of these powers, by the units of the constants.
    pub value: f64,
    /// Standard deviation of the sum, which is the relative one of the product.
    pub deviation: f64,
}

/// Information of a fit on the constants.
#[derive(Clone, Debug, PartialEq)]
pub struct Information {
    /// Covariance of the constants in the squares of their units, whatever the others are, without what nothing tells at all; zero of those at bounds.
    pub covariance: DMatrix<f64>,
    /// True for constants that the data determine: by their own intervals, all others being unknown.
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
        Self::new(task, &fit.weighted(), values, &fit.is_at_bound, freedom)
    }

    /// The information of derivatives in standard deviations.
    pub(super) fn new(
        task: &Identification,
        weighted: &DMatrix<f64>,
        values: &[f64],
        is_held: &[bool],
        freedom: Option<usize>,
    ) -> Self {
        let constants = values.len();
        let scales = scales(task, values);
        // A bound tells nothing of the data: what they determine is asked of all constants.
        let inside = is_held.iter().filter(|held| !**held).count();
        let mut own = weighted.columns(0, constants).into_owned();
        for (mut column, scale) in own.column_iter_mut().zip(&scales) {
            column *= *scale;
        }
        let starts = weighted.columns(constants, weighted.ncols() - constants);
        let (factor, ellipsoid) = quantiles(inside, freedom);
        let [singular, directions] = without(own, &starts.into_owned());
        let least = ROUND_OFF * singular.amax();
        let is_known = |&k: &usize| singular[k] > least;
        let known: Vec<usize> = (0..constants).filter(is_known).collect();
        let open: Vec<usize> = (0..constants).filter(|k| !is_known(k)).collect();
        let relative = by_directions(&directions, &known, |k| singular[k].recip());
        let unknown = by_directions(&directions, &open, |_| least.recip());
        let is_wide = |j: usize| {
            let variance = relative[(j, j)];
            unknown[(j, j)] > variance || factor * variance.sqrt() >= 1.0
        };
        let is_wide: Vec<bool> = (0..constants).map(is_wide).collect();
        let vague: Vec<usize> = (0..constants)
            .filter(|&j| is_held[j] || is_wide[j])
            .collect();
        let by_others = by_others(&relative, &vague);
        let is_determined: Vec<bool> = (0..constants)
            .map(|j| !is_wide[j] && !by_others[j])
            .collect();
        let is_inside = |i: usize, j: usize| !is_held[i] && !is_held[j];
        let covariance = |i: usize, j: usize| match is_inside(i, j) {
            true => relative[(i, j)] * scales[i] * scales[j],
            false => 0.0,
        };
        let deviation = |k: usize| match singular[k] > least {
            true => singular[k].recip(),
            false => f64::INFINITY,
        };
        let wide = (0..constants).map(|k| (k, deviation(k)));
        let wide = wide.filter(|(_, deviation)| factor * deviation >= 1.0);
        let undetermined = combinations(&directions, wide, &is_determined, &relative);
        let mut out = Self {
            covariance: DMatrix::from_fn(constants, constants, covariance),
            is_determined,
            undetermined,
            factor,
            ellipsoid,
            finite_variance: known.iter().map(|&k| singular[k].powi(-2)).sum(),
        };
        if let [only] = &mut out.undetermined[..] {
            only.determined = product(only, values, &directions, &known, deviation);
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
    let scale = |parameter: &Parameter, value: f64| match parameter.upper - parameter.lower {
        _ if parameter.lower > 0.0 => value,
        width if width.is_finite() => width,
        _ => value.abs().max(parameter.size()),
    };
    let pairs = task.parameters.iter().zip(values);
    pairs
        .map(|(parameter, value)| scale(parameter, *value))
        .collect()
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

/// Σ of the squares of some directions times deviations.
fn by_directions(
    directions: &DMatrix<f64>,
    which: &[usize],
    deviation: impl Fn(usize) -> f64,
) -> DMatrix<f64> {
    let count = directions.nrows();
    let mut out = DMatrix::zeros(count, count);
    for &k in which {
        let scaled = directions.column(k) * deviation(k);
        out += &scaled * scaled.transpose();
    }
    out
}

/// True for constants of which most of the variance is that of others that are open: at bounds, or with a wide interval of their own.
fn by_others(covariance: &DMatrix<f64>, open: &[usize]) -> Vec<bool> {
    if open.is_empty() {
        return vec![false; covariance.nrows()];
    }
    let deviations = covariance.diagonal().map(f64::sqrt);
    let correlation = |i: usize, j: usize| {
        let size = deviations[i] * deviations[j];
        if size > 0.0 {
            covariance[(i, j)] / size
        } else {
            0.0
        }
    };
    let of_open = DMatrix::from_fn(open.len(), open.len(), |i, j| correlation(open[i], open[j]));
    let inverse = of_open
        .pseudo_inverse(ROUND_OFF)
        .expect("a tolerance above zero");
    let is_by_others = |j: usize| {
        let with = DVector::from_fn(open.len(), |i, _| correlation(open[i], j));
        let left = 1.0 - with.dot(&(&inverse * &with));
        !open.contains(&j) && BY_OTHERS * left < 1.0
    };
    (0..deviations.len()).map(is_by_others).collect()
}

/// Combinations that are not determined: directions with a wide deviation, and single constants that none of them names.
fn combinations(
    directions: &DMatrix<f64>,
    wide: impl Iterator<Item = (usize, f64)>,
    is_determined: &[bool],
    covariance: &DMatrix<f64>,
) -> Vec<Undetermined> {
    let mut out: Vec<Undetermined> = Vec::new();
    for (k, deviation) in wide {
        let powers = named(directions.column(k).as_slice());
        let names = powers.iter().map(|&(j, _)| j);
        let constants: Vec<usize> = names.filter(|&j| !is_determined[j]).collect();
        if !constants.is_empty() {
            out.push(Undetermined {
                powers,
                constants,
                deviation,
                determined: None,
            });
        }
    }
    let is_left = |&j: &usize| {
        let is_named = out.iter().any(|one| one.constants.contains(&j));
        !is_determined[j] && !is_named
    };
    let left: Vec<usize> = (0..is_determined.len()).filter(is_left).collect();
    out.extend(left.into_iter().map(|j| Undetermined {
        powers: vec![(j, 1.0)],
        constants: vec![j],
        deviation: covariance[(j, j)].sqrt(),
        determined: None,
    }));
    out
}

/// The powers of constants in a direction, of which the largest is 1.
fn named(direction: &[f64]) -> Vec<(usize, f64)> {
    let largest = direction
        .iter()
        .copied()
        .fold(0.0, |a: f64, b: f64| match b.abs() > a.abs() {
            true => b,
            false => a,
        });
    let powers = direction.iter().map(|power| power / largest).enumerate();
    powers.filter(|(_, power)| power.abs() >= PART).collect()
}

/// The combination that is determined of two constants where only one combination of them is not.
fn product(
    open: &Undetermined,
    values: &[f64],
    directions: &DMatrix<f64>,
    known: &[usize],
    deviation: impl Fn(usize) -> f64,
) -> Option<Product> {
    let ([(a, p), (b, q)], 2) = (&open.powers[..], open.constants.len()) else {
        return None;
    };
    // Across the direction, with a first power of one that is the largest, about.
    let [(a, p), (b, q)] = if p.abs() > (1.0 + PART) * q.abs() {
        [(b, q), (a, p)]
    } else {
        [(a, p), (b, q)]
    };
    let powers = vec![(*a, 1.0), (*b, -p / q)];
    let value = powers
        .iter()
        .map(|&(j, power)| values[j].powf(power))
        .product();
    let of = |&k: &usize| {
        let change = directions[(*a, k)] - p / q * directions[(*b, k)];
        (change * deviation(k)).powi(2)
    };
    let variance: f64 = known.iter().map(of).sum();
    Some(Product {
        powers,
        value,
        deviation: variance.sqrt(),
    })
}
