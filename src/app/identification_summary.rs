//! Constants that were identified, in `summary.json` and in words.
//!
//! Verdicts on an identification: its status, and remarks in words.

use crate::control::problem::{self, Recording};
use crate::files::Entries;
use crate::identify::{
    Ended, Experiment, FittedMotion, HeldOut, Identified, NONE, Product, Series, Undetermined,
    Whiteness,
};
use crate::math::{prefixed, significant};
use crate::model::{SiUnit, System};
use crate::workflow::Remarks;
use serde::Serialize;

/// A fit and its assessment.
#[derive(Clone, Copy, Debug)]
pub(super) struct Identification<'a> {
    pub(super) system: &'a System,
    pub(super) task: &'a problem::Identification,
    pub(super) found: &'a Identified,
    /// Recordings as the fit predicts them.
    pub(super) motions: &'a [FittedMotion],
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
        let undetermined = found.information.undetermined.iter();
        let of = |one: &FittedMotion| &task.recordings[one.recording];
        let starts = self.motions.iter().filter(|one| of(one).seeks_start());
        let starts = starts.filter(|one| !of(one).is_held_out);
        let starts = starts.map(|one| self.start(one));
        let held_out = found.held_out.iter().map(|one| self.prediction(one));
        let experiments = found.experiments.iter().map(|one| self.candidate(one));
        Entries::default()
            .with_each("constants", constants.clone().map(|j| self.constant(j)))
            // None of constants without an interval.
            .with_each("correlation", constants.clone().map(row))
            .with_each(
                "undetermined",
                undetermined.map(|one| self.combination(one)),
            )
            .with("readings", found.fit.residuals().len())
            .with("unknowns", found.fit.free())
            .with("reduced_chi_square", self.reduced())
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
        let rows = self.rows().into_iter();
        let rows = rows.map(|(name, value)| format!("{name}: {value}"));
        let lines: Vec<String> = rows.chain(self.verdicts()).collect();
        lines.join("\n")
    }

    /// Rows of the page: the constants, and how well the model fits.
    pub(super) fn rows(&self) -> Vec<(String, String)> {
        let constants = self.task.parameters.iter().enumerate();
        let constants = constants.map(|(j, one)| (one.name.clone(), self.in_words(j)));
        let reduced = ("reduced χ²".to_owned(), significant(self.reduced(), 3));
        constants.chain([reduced]).collect()
    }

    /// A constant with its standard error and its interval in the unit that suits it: `122.97 kPa ± 0.12 (95 %: 122.73 to 123.21)`.
    fn in_words(&self, constant: usize) -> String {
        let Some(value) = self.value(constant) else {
            return "not determined".to_owned();
        };
        let (half, unit) = (self.half(constant), self.unit(constant).symbol);
        let (unit, factor) = prefixed(value.abs().max(half.unwrap_or(0.0)), unit);
        let (value, unit) = (factor * value, format!(" {unit}"));
        let unit = unit.trim_end();
        let Some(half) = half.map(|half| factor * half) else {
            return format!("{}{unit}, at its bound", significant(value, 6));
        };
        let error = half / self.found.information.factor;
        // Two digits of the error.
        let decimals = (1.0 - error.log10().floor()).clamp(0.0, 12.0) as usize;
        let [from, to] = [value - half, value + half];
        format!(
            "{value:.decimals$}{unit} ± {error:.decimals$} (95 %: {from:.decimals$} to {to:.decimals$})"
        )
    }

    /// Squared residuals in standard deviations over the degrees of freedom.
    fn reduced(&self) -> f64 {
        let fit = &self.found.fit;
        fit.sum() / fit.freedom().max(1) as f64
    }

    /// Combinations that the data leave open, verdicts on recordings that were held out, and the best next experiment.
    pub(super) fn verdicts(&self) -> Vec<String> {
        let Self { task, found, .. } = *self;
        let mut lines = Vec::new();
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
        lines
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
    fn start(&self, one: &FittedMotion) -> Entries {
        let joints = one.start().map(|(name, unit, value, rate)| {
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

/// Probability of residuals of the fit below which its model does not explain them, whatever else it predicts.
const BEYOND_CHANCE: f64 = 1e-6;

/// Readings of a quantity below which their scatter tells too little of their standard deviation.
const FEW: usize = 15;
/// Standard deviations beyond which, with a probability of 1 %, a constant lies from its prior.
const APART: f64 = 2.576;
/// Least part of the variance of a prior that recordings take from it, where they can check it; less is rounding.
const TAKEN: f64 = 1e-9;

/// Powers of constants as a product, such as `a / b^2`.
fn product(task: &problem::Identification, powers: &[(usize, f64)]) -> String {
    let factor = |&(j, power): &(usize, f64)| {
        let name = &task.parameters[j].name;
        match (power * 1e3).round() / 1e3 {
            1.0 => name.clone(),
            power => format!("{name}^{power}"),
        }
    };
    let list: Vec<String> = powers.iter().map(factor).collect();
    list.join(" · ")
}

/// Constants that are not determined alone, and what is determined of them near the estimate.
fn words(task: &problem::Identification, one: &Undetermined) -> String {
    let name = |j: usize| task.parameters[j].name.as_str();
    let names: Vec<&str> = one.constants.iter().map(|&j| name(j)).collect();
    let [only] = names[..] else {
        let text = format!(
            "the data determine {} only in combination",
            names.join(" and ")
        );
        return match &one.determined {
            Some(known) => format!("{text}: {}", relative(known, name)),
            None => text,
        };
    };
    format!("the data do not determine {only}")
}

/// The sum of relative changes of two constants that is determined.
fn relative<'a>(known: &Product, name: impl Fn(usize) -> &'a str) -> String {
    let [(a, _), (b, factor)] = known.powers[..] else {
        return String::new();
    };
    let sign = if factor < 0.0 { "minus" } else { "plus" };
    let times = match (factor.abs() * 1e3).round() / 1e3 {
        1.0 => "that".to_owned(),
        _ => format!("{} times that", significant(factor.abs(), 3)),
    };
    format!(
        "near the estimate they know the relative change of {} {sign} {times} of {} within ± {} % (one standard error)",
        name(a),
        name(b),
        significant(100.0 * known.deviation, 2)
    )
}

/// Greatest exponent of a product of powers that says something, and its reciprocal.
const PLAIN: f64 = 4.0;

/// Returns true if a product of powers says more than the sum of relative changes does.
fn is_plain(known: &Product) -> bool {
    let mut powers = known.powers.iter().map(|(_, power)| power.abs());
    powers.all(|power| (PLAIN.recip()..=PLAIN).contains(&power))
}

/// Status of a result, in one word.
pub(super) fn status(found: &Identified) -> &'static str {
    let is_explained = found.held_out.iter().all(HeldOut::is_explained);
    match () {
        () if found.fit.ended == Ended::Unfinished => "not_converged",
        () if !found.information.undetermined.is_empty() => "not_determined",
        () if !is_explained || found.p.is_some_and(|p| p < BEYOND_CHANCE) => "not_explained",
        () if !found.bias.is_confirmed => "bias_not_confirmed",
        () if found.held_out.is_empty() => "identified",
        () => "explained",
    }
}

/// Verdict on a recording that was held out.
fn verdict(of: &HeldOut) -> &'static str {
    match of.is_explained() {
        true => "explained",
        false => "not explained",
    }
}

/// The same with the numbers that decide it.
fn prediction(recording: &Recording, of: &HeldOut) -> String {
    let not_white = of.not_white().map(|(channel, p)| {
        let name = &recording.channels[channel].name;
        format!("; differences of {name} are not white, Ljung-Box p = {p:.1e}")
    });
    format!(
        "{}: {} (reduced χ² of the prediction {}, 1 % beyond {}{})",
        recording.name,
        verdict(of),
        significant(of.statistic, 3),
        significant(of.quantile, 3),
        not_white.collect::<String>()
    )
}

/// A recording of which a table of voltages or loads ends before its last reading.
fn beyond(recording: &Recording) -> Option<String> {
    let last = recording.readings().map(|reading| reading.time);
    let last = last.fold(0.0, f64::max);
    let end = recording.voltages.last_known()?;
    (end < last).then(|| {
        format!(
            "recording \"{}\": a table of its voltages or loads ends at {} s, before the last reading at {} s; its last values go on",
            recording.name,
            significant(1e-3 * end, 4),
            significant(1e-3 * last, 4)
        )
    })
}

/// That the grid biases the constants, or how little it does.
fn of_grid(found: &Identified, remarks: &mut Remarks) {
    let bias = &found.bias;
    let errors = || significant(bias.largest(), 2);
    let last = "the last halving of the steps changes";
    let text = match bias.is_confirmed {
        true if !bias.is_small() => format!(
            "{last} no constant by more than {NONE:.0e} of its value; that is {} standard errors, as the readings have hardly any scatter",
            errors()
        ),
        true => format!(
            "{last} no constant by more than {} standard errors",
            errors()
        ),
        false if bias.largest().is_infinite() => {
            "no fit on a finer grid tells how far the grid biases the result".to_owned()
        }
        false if bias.is_small() => format!(
            "{last} a standard error by {} %: the intervals are not confirmed",
            significant(100.0 * bias.errors, 2)
        ),
        false => format!(
            "{last} a constant by {} standard errors: the grid biases the result",
            errors()
        ),
    };
    match bias.is_confirmed {
        true => remarks.note("grid", [text]),
        false => remarks.warn("bias_not_confirmed", [text]),
    }
}

/// That the interval of a constant is not confirmed by the squares of the residuals at its ends.
fn of_interval(name: &str, ends: [Option<f64>; 2]) -> String {
    let sides = ["lower", "upper"].into_iter().zip(ends);
    let told = sides.filter_map(|(side, rise)| {
        let rise = rise?;
        Some(match rise.is_finite() {
            true => format!("{} times at the {side} end", significant(rise, 2)),
            false => format!("no simulation at the {side} end"),
        })
    });
    format!(
        "the interval of {name} follows from derivatives at the estimate, and is not confirmed: at its ends the squared residuals rise otherwise than these foretell ({})",
        told.collect::<Vec<_>>().join(", ")
    )
}

/// Warnings and notes on a result.
pub(super) fn remarks(task: &problem::Identification, found: &Identified) -> Remarks {
    let mut remarks = Remarks::default();
    let at_bound = task.parameters.iter().zip(&found.fit.is_at_bound);
    let at_bound = at_bound.filter(|(_, held)| **held);
    remarks.warn(
        "at_bound",
        at_bound.map(|(p, _)| format!("{} lies at its bound: the fit would go on", p.name)),
    );
    let open = found.information.undetermined.iter();
    remarks.warn("not_determined", open.map(|one| words(task, one)));
    if !found.is_white() {
        let text = "the residuals are not white (Ljung-Box, 1 %): the model misses part of the motion, or errors of neighbouring readings are alike, and intervals are too short";
        remarks.warn("not_white", [text.to_owned()]);
    }
    if let Some(p) = found.p.filter(|p| *p < 0.01) {
        let text = format!(
            "the residuals are larger than the standard deviations of the readings say (p = {p:.1e})"
        );
        remarks.warn("large_residuals", [text]);
    }
    of_grid(found, &mut remarks);
    let few = found.fit.fewest().filter(|count| *count < FEW);
    let few = few.map(|count| {
        format!(
            "the scatter of a quantity is estimated from its {count} readings, and its weight with it: intervals are too narrow; give its \"standard_deviation\""
        )
    });
    remarks.warn("few_readings", few);
    let unlike = found.rises.unlike();
    let unlike = unlike.map(|(j, ends)| of_interval(&task.parameters[j].name, ends));
    remarks.warn("interval_not_confirmed", unlike);
    let differences = found.fit.of_priors(task);
    let compared = task.priors.iter().zip(differences).map(|(prior, z)| {
        // Where both agree, the estimate differs from the mean with the variance that the recordings take from that of the prior.
        let place = (prior.constant, prior.constant);
        let taken = 1.0 - found.information.covariance[place] / prior.deviation.powi(2);
        (prior, (taken > TAKEN).then(|| z / taken.sqrt()))
    });
    let compared: Vec<_> = compared.collect();
    let alone = compared.iter().filter(|(_, z)| z.is_none());
    remarks.note(
        "prior_not_checked",
        alone.map(|(prior, _)| {
            format!(
                "the prior of {} alone decides its value: it is too narrow for the recordings to check it",
                task.parameters[prior.constant].name
            )
        }),
    );
    let compared = compared
        .iter()
        .filter_map(|(prior, z)| Some((prior, (*z)?)));
    let apart = compared.filter(|(_, z)| z.abs() > APART);
    remarks.warn(
        "prior_contradicted",
        apart.map(|(prior, z)| {
            format!(
                "the recordings pull {} {} standard deviations away from its prior: one of them is wrong",
                task.parameters[prior.constant].name,
                significant(z.abs(), 2)
            )
        }),
    );
    remarks.note("inputs_end", task.recordings.iter().filter_map(beyond));
    if found.held_out.is_empty() {
        let text = "no recording is held out: nothing checks the prediction";
        remarks.note("nothing_held_out", [text.to_owned()]);
    }
    remarks
}
