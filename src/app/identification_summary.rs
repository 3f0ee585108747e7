//! Constants that were identified, in `summary.json` and in words.

use serde::Serialize;

use crate::app::identification_verdict::{is_plain, prediction, product, verdict, words};
use crate::control::problem;
use crate::identify::{Experiment, FoundStart, HeldOut, Identified, Undetermined, Whiteness};
use crate::math::significant;
use crate::model::{Parameter, SiUnit, System};

/// Result of an identification.
#[derive(Debug, Serialize)]
pub(super) struct Identification {
    /// The constants.
    constants: Vec<Found>,
    /// Correlations of all pairs of constants, in their order; none of those without an interval.
    correlation: Vec<Vec<Option<f64>>>,
    /// Combinations that the data do not determine.
    undetermined: Vec<Combination>,
    readings: usize,
    unknowns: usize,
    /// Σ of the squared residuals in standard deviations over the degrees of freedom.
    reduced_chi_square: f64,
    /// Probability of so large residuals, where the standard deviations are known.
    #[serde(skip_serializing_if = "Option::is_none")]
    p: Option<f64>,
    grid: GridBias,
    /// Starts that were sought.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    starts: Vec<Start>,
    fitted: Vec<Residuals>,
    held_out: Vec<Prediction>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    next_experiments: Vec<Candidate>,
}

/// A constant.
#[derive(Debug, Serialize)]
struct Found {
    name: String,
    unit: &'static str,
    /// Absent where the data do not determine it.
    #[serde(skip_serializing_if = "Option::is_none")]
    value: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    standard_error: Option<f64>,
    /// Interval of 95 %.
    #[serde(skip_serializing_if = "Option::is_none")]
    interval: Option<[f64; 2]>,
    at_bound: bool,
    /// Known beside the recordings.
    #[serde(skip_serializing_if = "Option::is_none")]
    prior: Option<Known>,
}

/// A normal distribution of a constant.
#[derive(Debug, Serialize)]
struct Known {
    value: f64,
    standard_deviation: f64,
}

/// A combination of constants that is not determined.
#[derive(Debug, Serialize)]
struct Combination {
    /// In words.
    text: String,
    /// Powers by which the constants change together.
    powers: Vec<Power>,
    /// The product that is determined, where its powers are plain ones.
    #[serde(skip_serializing_if = "Option::is_none")]
    determined: Option<Determined>,
}

#[derive(Debug, Serialize)]
struct Power {
    name: String,
    power: f64,
}

#[derive(Debug, Serialize)]
struct Determined {
    product: String,
    /// In SI units.
    value: f64,
    standard_error: f64,
}

/// Grid of the last fit.
#[derive(Debug, Serialize)]
struct GridBias {
    intervals: Vec<usize>,
    halvings: usize,
    /// Largest change of a constant by the last halving, in standard errors; absent where there was none.
    #[serde(skip_serializing_if = "Option::is_none")]
    largest_change: Option<f64>,
    confirmed: bool,
}

/// The start of a recording that was sought.
#[derive(Debug, Serialize)]
struct Start {
    recording: String,
    joints: Vec<StartJoint>,
}

/// Coordinate of a joint at a start.
#[derive(Debug, Serialize)]
struct StartJoint {
    name: String,
    /// Unit of the coordinate; that of its rate is this one over s.
    unit: &'static str,
    value: f64,
    rate: f64,
}

/// Residuals of a quantity of a recording.
#[derive(Debug, Serialize)]
struct Residuals {
    recording: String,
    quantity: String,
    readings: usize,
    /// Root of the mean squared residual, in SI units.
    rms: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    whiteness: Option<Test>,
}

/// A test of whiteness.
#[derive(Debug, Serialize)]
struct Test {
    ljung_box: f64,
    lags: usize,
    p: f64,
    neighbours: f64,
}

/// A recording that was held out.
#[derive(Debug, Serialize)]
struct Prediction {
    recording: String,
    /// `explained` or `not explained`.
    verdict: &'static str,
    /// Squared differences over those that the deviations of readings and constants let expect.
    statistic: f64,
    /// The value that it exceeds with a probability of 1 %.
    quantile: f64,
    p: f64,
    /// Quantities whose differences are not white.
    not_white: Vec<String>,
    /// The same as the statistic by the deviations of the readings alone.
    reduced_chi_square: f64,
    /// The verdict with its reason.
    #[serde(skip)]
    text: String,
    residuals: Vec<Residuals>,
}

/// A candidate for the next experiment.
#[derive(Debug, Serialize)]
struct Candidate {
    name: String,
    /// Standard errors of the constants after it, in SI units; absent of those that are not determined then.
    standard_errors: Vec<Option<f64>>,
    undetermined: usize,
}

fn unit(system: &System, parameter: &Parameter) -> SiUnit {
    parameter.unit(system)
}

impl From<&Whiteness> for Test {
    fn from(test: &Whiteness) -> Self {
        Self {
            ljung_box: test.statistic,
            lags: test.lags,
            p: test.p,
            neighbours: test.neighbours,
        }
    }
}

fn residuals(
    task: &problem::Identification,
    series: &[crate::identify::Series],
    whiteness: &[Option<Whiteness>],
) -> Vec<Residuals> {
    let of = |(one, test): (&crate::identify::Series, &Option<Whiteness>)| {
        let recording = &task.recordings[one.recording];
        let channel = &recording.channels[one.channel];
        let pairs = one.measured.iter().zip(&one.predicted);
        let sum: f64 = pairs.map(|(m, p)| (m - p).powi(2)).sum();
        Residuals {
            recording: recording.name.clone(),
            quantity: channel.name.clone(),
            readings: one.times.len(),
            rms: channel.unit.1 * (sum / one.times.len() as f64).sqrt(),
            whiteness: test.as_ref().map(Test::from),
        }
    };
    series.iter().zip(whiteness).map(of).collect()
}

impl Identification {
    /// Of a fit and its assessment.
    pub(super) fn new(
        system: &System,
        task: &problem::Identification,
        (found, starts): (&Identified, &[FoundStart]),
    ) -> Self {
        let information = &found.information;
        let units: Vec<SiUnit> = task.parameters.iter().map(|p| unit(system, p)).collect();
        let values = found.fit.of_constants();
        let has_interval = |j: usize| information.is_determined[j] && !found.fit.is_at_bound[j];
        let constant = |(j, parameter): (usize, &Parameter)| {
            let factor = units[j].factor;
            let value = factor * values[j];
            let half = has_interval(j).then(|| factor * information.half(j));
            Found {
                name: parameter.name.clone(),
                unit: units[j].symbol,
                value: information.is_determined[j].then_some(value),
                standard_error: half.map(|half| half / information.factor),
                interval: half.map(|half| [value - half, value + half]),
                at_bound: found.fit.is_at_bound[j],
                prior: Known::new(task, j, factor),
            }
        };
        let count = task.parameters.len();
        let pair =
            |i, j| (has_interval(i) && has_interval(j)).then(|| information.correlation(i, j));
        let rows = (0..count).map(|i| (0..count).map(|j| pair(i, j)).collect());
        let combination = |one: &Undetermined| Combination::new(task, one, &units);
        let largest = found.bias.largest();
        let doubled = |&r: &usize| 2 * found.grid.intervals[r];
        Self {
            constants: task.parameters.iter().enumerate().map(constant).collect(),
            correlation: rows.collect(),
            undetermined: information.undetermined.iter().map(combination).collect(),
            readings: found.fit.residuals().len(),
            unknowns: found.fit.free(),
            reduced_chi_square: found.fit.sum() / found.fit.freedom().max(1) as f64,
            p: found.p,
            grid: GridBias {
                intervals: found.fitted.iter().map(doubled).collect(),
                halvings: found.bias.halvings,
                largest_change: largest.is_finite().then_some(largest),
                confirmed: found.bias.is_confirmed,
            },
            starts: starts
                .iter()
                .map(|one| Start::new(system, task, one))
                .collect(),
            fitted: residuals(task, &found.series, &found.whiteness),
            held_out: found
                .held_out
                .iter()
                .map(|one| Prediction::new(task, one))
                .collect(),
            next_experiments: (found.experiments.iter())
                .map(|one| Candidate::new(task, one, &units))
                .collect(),
        }
    }

    /// In words, a line for each constant and verdict.
    pub(super) fn text(&self) -> String {
        let mut lines = Vec::new();
        for one in &self.constants {
            let text = match (one.value, one.interval) {
                (Some(value), Some([low, high])) => format!(
                    "{} = {} {} (95 %: {} to {})",
                    one.name,
                    significant(value, 6),
                    one.unit,
                    significant(low, 6),
                    significant(high, 6)
                ),
                (Some(value), None) => {
                    format!(
                        "{} = {} {}, at its bound",
                        one.name,
                        significant(value, 6),
                        one.unit
                    )
                }
                _ => format!("{} is not determined", one.name),
            };
            lines.push(text);
        }
        for one in &self.undetermined {
            lines.push(one.text.clone());
            if let Some(product) = &one.determined {
                lines.push(format!(
                    "{} = {} ± {} in SI units (one standard error)",
                    product.product,
                    significant(product.value, 6),
                    significant(product.standard_error, 2)
                ));
            }
        }
        lines.extend(self.held_out.iter().map(|one| one.text.clone()));
        if let Some(best) = self.next_experiments.first() {
            lines.push(format!("next experiment: {}", best.name));
        }
        lines.join("\n")
    }
}

impl Combination {
    fn new(task: &problem::Identification, one: &Undetermined, units: &[SiUnit]) -> Self {
        let name = |j: usize| task.parameters[j].name.clone();
        let power = |&(j, power): &(usize, f64)| Power {
            name: name(j),
            power,
        };
        Self {
            text: words(task, one),
            powers: one.powers.iter().map(power).collect(),
            determined: one
                .determined
                .as_ref()
                .filter(|known| is_plain(known))
                .map(|known| {
                    let powers = known.powers.iter();
                    let si = powers.map(|&(j, power)| units[j].factor.powf(power));
                    let value = known.value * si.product::<f64>();
                    Determined {
                        product: product(task, &known.powers),
                        value,
                        standard_error: (value * known.deviation).abs(),
                    }
                }),
        }
    }
}

impl Known {
    /// The prior of a constant in its SI unit, where it has one.
    fn new(task: &problem::Identification, constant: usize, factor: f64) -> Option<Self> {
        let known = task.priors.iter().find(|one| one.constant == constant)?;
        Some(Self {
            value: factor * known.value,
            standard_deviation: factor * known.deviation,
        })
    }
}

impl Start {
    fn new(system: &System, task: &problem::Identification, one: &FoundStart) -> Self {
        let joints = one.in_si(system);
        let joints = joints.map(|(name, unit, value, rate)| StartJoint {
            name: name.to_owned(),
            unit,
            value,
            rate,
        });
        Self {
            recording: task.recordings[one.recording].name.clone(),
            joints: joints.collect(),
        }
    }
}

impl Prediction {
    fn new(task: &problem::Identification, one: &HeldOut) -> Self {
        let recording = &task.recordings[one.recording];
        Self {
            recording: recording.name.clone(),
            verdict: verdict(one),
            statistic: one.statistic,
            quantile: one.quantile,
            p: one.p,
            not_white: one
                .not_white()
                .map(|(channel, _)| recording.channels[channel].name.clone())
                .collect(),
            reduced_chi_square: one.reduced,
            text: prediction(recording, one),
            residuals: residuals(task, &one.series, &one.whiteness),
        }
    }
}

impl Candidate {
    fn new(task: &problem::Identification, one: &Experiment, units: &[SiUnit]) -> Self {
        let information = &one.information;
        let error = |j: usize| {
            let variance = information.covariance[(j, j)];
            (information.is_determined[j]).then(|| units[j].factor * variance.sqrt())
        };
        Self {
            name: task.candidates[one.candidate].name.clone(),
            standard_errors: (0..units.len()).map(error).collect(),
            undetermined: information.undetermined.len(),
        }
    }
}
