//! Warnings about the steps of a simulation that do not resolve its motion, with steps that would.

use crate::control::problem::Simulation;
use crate::dynamics::{DiscreteTrajectory, LocalError};
use crate::math::{shortest, significant};
use crate::nlp::Status;
use crate::workflow::integrate::grid;
use crate::workflow::tolerance::EstimatedError;

/// Part of the path beyond which the estimated error of a motion is warned of.
const FINE: f64 = 0.01;

/// Part of the greatest energy that a step exchanged beyond which the energy that all of them made is warned of.
const BALANCED: f64 = 0.05;

/// A warning where the steps make or lose energy of their own.
pub(crate) fn unbalanced(discrete: &DiscreteTrajectory) -> Option<String> {
    let report = discrete.report;
    let part = report.made / report.exchanged;
    let count = discrete.intervals();
    let step = rounded(discrete.times.last()? / count.max(1) as f64);
    (count > 0 && part.abs() > BALANCED).then(|| {
        format!(
            "time steps of {step} ms {} {} mJ of numerical energy ({:.0} % of the peak exchange); use shorter steps",
            if part > 0.0 { "add" } else { "remove" },
            significant(report.made.abs(), 3),
            100.0 * part.abs()
        )
    })
}

/// The step that is taken where the one that is written does not divide the duration.
pub fn divided(task: &Simulation) -> Option<String> {
    let (steps, step) = grid(task);
    let is_other = (step - task.step).abs() > 1e-6 * task.step;
    (task.tolerance.is_none() && is_other).then(|| {
        format!(
            "the step is {} ms, the duration in {steps} equal steps: steps of {} ms do not divide it",
            shortest(step, 6),
            shortest(task.step, 6)
        )
    })
}

/// A warning where the steps do not resolve the motion well, or are too few for an estimate.
pub(crate) fn warning(
    error: Option<LocalError>,
    discrete: &DiscreteTrajectory,
    task: &Simulation,
) -> Option<String> {
    let Some(error) = error else {
        let enough = task.solving.integrator.order() + 1;
        return (1..enough).contains(&discrete.intervals()).then(|| {
            format!("the error of so few steps cannot be estimated; {enough} would be enough")
        });
    };
    let (relative, step) = (error.relative(), rounded(error.step));
    if relative <= FINE {
        return None;
    }
    if let Some(tolerance) = task.tolerance {
        return Some(format!(
            "steps by a tolerance of {tolerance:e} leave an estimated error of {:.2} mm, {:.1} % of the path of {:.1} mm; a tolerance of {:.1e} would leave {} %",
            error.error,
            100.0 * relative,
            error.path,
            tolerance * FINE / relative,
            100.0 * FINE
        ));
    }
    let better = error.step_for(FINE);
    Some(match error.is_resolved {
        true => format!(
            "the steps of {step} ms leave an estimated error of {:.2} mm, {:.1} % of the path of {:.1} mm; steps of {better} ms would leave {} %",
            error.error,
            100.0 * relative,
            error.path,
            100.0 * FINE
        ),
        false => format!(
            "the steps of {step} ms do not resolve the motion: the estimated error is {:.2} mm, {:.0} % of the path of {:.1} mm; try {better} ms",
            error.error,
            100.0 * relative,
            error.path
        ),
    })
}

/// A warning where the error of a motion is not confirmed to be below its tolerance.
pub fn beyond(error: Option<EstimatedError>, task: &Simulation) -> Option<String> {
    let (error, tolerance) = (error?, task.tolerance?);
    let size = significant(error.error, 2);
    match (error.error <= tolerance, error.is_confirmed) {
        (true, true) => None,
        (false, true) => Some(format!(
            "the estimated error of the motion is {size}, above the tolerance of {tolerance:e}, with the shortest steps that were tried"
        )),
        (_, false) => Some(format!(
            "the error of the motion is not known: steps of other lengths lead elsewhere, {size} away (the tolerance is {tolerance:e})"
        )),
    }
}

/// A warning that a stop left open whether the error of a motion is below its tolerance.
pub(crate) fn unconfirmed(stopped: Status) -> String {
    format!(
        "the run was stopped ({}) before steps of other lengths confirmed that the error of the motion is below its tolerance",
        stopped.word().replace('_', " ")
    )
}

/// Three digits of a step.
fn rounded(step: f64) -> f64 {
    let digits = 10_f64.powf(2.0 - step.log10().floor());
    (step * digits).round() / digits
}

/// The number of steps, and between what their lengths lie where a tolerance controls them.
pub fn counted(discrete: &DiscreteTrajectory, task: &Simulation) -> String {
    let count = discrete.intervals().to_string();
    let lengths = discrete.times.windows(2).map(|ends| ends[1] - ends[0]);
    let ends = (f64::INFINITY, 0.0_f64);
    let (least, most) = lengths.fold(ends, |(low, high), h| (low.min(h), high.max(h)));
    match task.tolerance {
        Some(_) if least.is_finite() => {
            format!("{count}, of {} to {} ms", rounded(least), rounded(most))
        }
        _ => count,
    }
}
