//! Constants that were identified, in `summary.json` and in words.

use serde::Serialize;

use crate::app::identification_verdict::{is_plain, prediction, product, verdict, words};
use crate::control::problem;
use crate::files::Entries;
use crate::identify::{
    Experiment, FoundStart, HeldOut, Identified, Series, Undetermined, Whiteness,
};
use crate::math::significant;
use crate::model::{SiUnit, System};

/// A fit and its assessment.
#[derive(Clone, Copy, Debug)]
pub(super) struct Identification<'a> {
    pub(super) system: &'a System,
    pub(super) task: &'a problem::Identification,
    pub(super) found: &'a Identified,
    /// Starts that were sought.
    pub(super) starts: &'a [FoundStart],
}

/// The product of constants that the data determine.
#[derive(Debug, Serialize)]
struct Determined {
    product: String,
    /// In SI units.
    value: f64,
    standard_error: f64,
}

impl Identification<'_> {
    /// Its part of the summary.
    pub(super) fn entries(&self) -> Entries {
        let Self { task, found, .. } = *self;
        let constants = 0..task.parameters.len();
        let pair = |i: usize, j: usize| {
            let both = self.half(i).and(self.half(j));
            both.map(|_| found.information.correlation(i, j))
        };
        let row = |i| constants.clone().map(|j| pair(i, j)).collect::<Vec<_>>();
        let each = |one| self.constant(one);
        let undetermined = found.information.undetermined.iter();
        let starts = self.starts.iter().map(|one| self.start(one));
        let held_out = found.held_out.iter().map(|one| self.prediction(one));
        let experiments = found.experiments.iter().map(|one| self.candidate(one));
        Entries::default()
            .with_each("constants", constants.clone().map(each))
            // None of constants without an interval.
            .with_each("correlation", constants.clone().map(row))
            .with_each(
                "undetermined",
                undetermined.map(|one| self.combination(one)),
            )
            .with("readings", found.fit.residuals().len())
            .with("unknowns", found.fit.free())
            // Σ of the squared residuals in standard deviations over the degrees of freedom.
            .with(
                "reduced_chi_square",
                found.fit.sum() / found.fit.freedom().max(1) as f64,
            )
            // Probability of so large residuals, where the standard deviations are known.
            .with_some("p", found.p)
            .with("grid", self.grid())
            .with_any("starts", starts)
            .with("fitted", self.residuals(&found.series, &found.whiteness))
            .with_each("held_out", held_out)
            .with_any("next_experiments", experiments)
    }

    /// In words, a line for each constant and verdict.
    pub(super) fn text(&self) -> String {
        let Self { task, found, .. } = *self;
        let mut lines = Vec::new();
        for (j, parameter) in task.parameters.iter().enumerate() {
            let (name, unit) = (&parameter.name, self.unit(j).symbol);
            let number = |value| significant(value, 6);
            lines.push(match (self.value(j), self.half(j)) {
                (Some(value), Some(half)) => {
                    let ends = [value - half, value + half].map(number);
                    let interval = format!("(95 %: {} to {})", ends[0], ends[1]);
                    format!("{name} = {} {unit} {interval}", number(value))
                }
                (Some(value), None) => format!("{name} = {} {unit}, at its bound", number(value)),
                _ => format!("{name} is not determined"),
            });
        }
        for one in &found.information.undetermined {
            lines.push(words(task, one));
            lines.extend(self.determined(one).map(|known| {
                format!(
                    "{} = {} ± {} in SI units (one standard error)",
                    known.product,
                    significant(known.value, 6),
                    significant(known.standard_error, 2)
                )
            }));
        }
        let held_out = found.held_out.iter();
        lines.extend(held_out.map(|one| prediction(&task.recordings[one.recording], one)));
        let best = found.experiments.first();
        let best = best.map(|one| &task.candidates[one.candidate].name);
        lines.extend(best.map(|name| format!("next experiment: {name}")));
        lines.join("\n")
    }

    /// SI unit of a constant.
    fn unit(&self, constant: usize) -> SiUnit {
        self.task.parameters[constant].unit(self.system)
    }

    /// Value of a constant in its SI unit, where the data determine it.
    fn value(&self, constant: usize) -> Option<f64> {
        let value = self.unit(constant).factor * self.found.fit.of_constants()[constant];
        self.found.information.is_determined[constant].then_some(value)
    }

    /// Half of its interval of 95 %, where it has one.
    fn half(&self, constant: usize) -> Option<f64> {
        let Identified {
            information, fit, ..
        } = self.found;
        let is_free = information.is_determined[constant] && !fit.is_at_bound[constant];
        is_free.then(|| self.unit(constant).factor * information.half(constant))
    }

    fn constant(&self, constant: usize) -> Entries {
        let (value, half) = (self.value(constant), self.half(constant));
        let factor = self.found.information.factor;
        let mut priors = self.task.priors.iter();
        let prior = priors.find(|one| one.constant == constant).map(|known| {
            let unit = self.unit(constant).factor;
            Entries::default()
                .with("value", unit * known.value)
                .with("standard_deviation", unit * known.deviation)
        });
        Entries::default()
            .with("name", &self.task.parameters[constant].name)
            .with("unit", self.unit(constant).symbol)
            .with_some("value", value)
            .with_some("standard_error", half.map(|half| half / factor))
            .with_some(
                "interval",
                value
                    .zip(half)
                    .map(|(value, half)| [value - half, value + half]),
            )
            .with("at_bound", self.found.fit.is_at_bound[constant])
            // Known beside the recordings.
            .with_some("prior", prior)
    }

    /// A combination of constants that is not determined, with the powers by which they change together.
    fn combination(&self, one: &Undetermined) -> Entries {
        let power = |&(j, power): &(usize, f64)| {
            let name = &self.task.parameters[j].name;
            Entries::default().with("name", name).with("power", power)
        };
        Entries::default()
            .with("text", words(self.task, one))
            .with_each("powers", one.powers.iter().map(power))
            .with_some("determined", self.determined(one))
    }

    /// The product that is determined, where its powers are plain ones.
    fn determined(&self, one: &Undetermined) -> Option<Determined> {
        let known = one.determined.as_ref().filter(|known| is_plain(known))?;
        let si = known
            .powers
            .iter()
            .map(|&(j, power)| self.unit(j).factor.powf(power));
        let value = known.value * si.product::<f64>();
        Some(Determined {
            product: product(self.task, &known.powers),
            value,
            standard_error: (value * known.deviation).abs(),
        })
    }

    /// Grid of the last fit, with the largest change of a constant by the last halving in standard errors, where there was one.
    fn grid(&self) -> Entries {
        let Identified {
            fitted, grid, bias, ..
        } = self.found;
        let doubled = |&recording: &usize| 2 * grid.intervals[recording];
        let largest = Some(bias.largest()).filter(|change| change.is_finite());
        Entries::default()
            .with_each("intervals", fitted.iter().map(doubled))
            .with("halvings", bias.halvings)
            .with_some("largest_change", largest)
            .with("confirmed", bias.is_confirmed)
    }

    /// The start of a recording; the unit of a rate is that of the coordinate over s.
    fn start(&self, one: &FoundStart) -> Entries {
        let joints = one.in_si(self.system).map(|(name, unit, value, rate)| {
            let joint = Entries::default().with("name", name).with("unit", unit);
            joint.with("value", value).with("rate", rate)
        });
        Entries::default()
            .with("recording", &self.task.recordings[one.recording].name)
            .with_each("joints", joints)
    }

    /// Residuals of quantities of recordings, with the roots of their mean squares in SI units.
    fn residuals(&self, series: &[Series], whiteness: &[Option<Whiteness>]) -> Vec<Entries> {
        let each = series.iter().zip(whiteness).map(|(one, test)| {
            let recording = &self.task.recordings[one.recording];
            let channel = &recording.channels[one.channel];
            let pairs = one.measured.iter().zip(&one.predicted);
            let sum: f64 = pairs.map(|(m, p)| (m - p).powi(2)).sum();
            let test = test.as_ref().map(|test| {
                Entries::default()
                    .with("ljung_box", test.statistic)
                    .with("lags", test.lags)
                    .with("p", test.p)
                    .with("neighbours", test.neighbours)
            });
            Entries::default()
                .with("recording", &recording.name)
                .with("quantity", &channel.name)
                .with("readings", one.times.len())
                .with(
                    "rms",
                    channel.unit.1 * (sum / one.times.len() as f64).sqrt(),
                )
                .with_some("whiteness", test)
        });
        each.collect()
    }

    /// A recording that was held out.
    fn prediction(&self, one: &HeldOut) -> Entries {
        let recording = &self.task.recordings[one.recording];
        let not_white = one.not_white();
        let not_white = not_white.map(|(channel, _)| recording.channels[channel].name.clone());
        Entries::default()
            .with("recording", &recording.name)
            .with("verdict", verdict(one))
            // Squared differences over those that the deviations of readings and constants let expect.
            .with("statistic", one.statistic)
            // It exceeds this with a probability of 1 %.
            .with("quantile", one.quantile)
            .with("p", one.p)
            .with_each("not_white", not_white)
            // The same as the statistic by the deviations of the readings alone.
            .with("reduced_chi_square", one.reduced)
            .with("residuals", self.residuals(&one.series, &one.whiteness))
    }

    /// A candidate for the next experiment, with the standard errors after it of constants that are determined then.
    fn candidate(&self, one: &Experiment) -> Entries {
        let information = &one.information;
        let error = |j: usize| {
            let variance = information.covariance[(j, j)];
            information.is_determined[j].then(|| self.unit(j).factor * variance.sqrt())
        };
        let errors = (0..self.task.parameters.len()).map(error);
        Entries::default()
            .with("name", &self.task.candidates[one.candidate].name)
            .with_each("standard_errors", errors)
            .with("undetermined", information.undetermined.len())
    }
}
