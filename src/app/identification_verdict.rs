//! Verdicts on an identification: its status, and remarks in words.

use crate::control::problem::{Identification, Recording};
use crate::identify::{Ended, HeldOut, Identified, NONE, Product, Undetermined};
use crate::math::significant;
use crate::workflow::Remarks;

/// Probability of residuals of the fit below which its model does not explain them, whatever else it predicts.
const BEYOND_CHANCE: f64 = 1e-6;

/// Readings of a quantity below which their scatter tells too little of their standard deviation.
const FEW: usize = 15;
/// Standard deviations beyond which, with a probability of 1 %, a constant lies from its prior.
const APART: f64 = 2.576;
/// Least part of the variance of a prior that recordings take from it, where they can check it; less is rounding.
const TAKEN: f64 = 1e-9;

/// Powers of constants as a product, such as `a / b^2`.
pub(super) fn product(task: &Identification, powers: &[(usize, f64)]) -> String {
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
pub(super) fn words(task: &Identification, one: &Undetermined) -> String {
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
pub(super) fn is_plain(known: &Product) -> bool {
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
pub(super) fn verdict(of: &HeldOut) -> &'static str {
    match of.is_explained() {
        true => "explained",
        false => "not explained",
    }
}

/// The same with the numbers that decide it.
pub(super) fn prediction(recording: &Recording, of: &HeldOut) -> String {
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
pub(super) fn remarks(task: &Identification, found: &Identified) -> Remarks {
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
