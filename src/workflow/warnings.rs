//! Warnings about a simulated motion: steps that do not resolve it, muscles outside the domain of their material.
//!
//! Error of a motion, from the same motion in steps of other lengths.
//!
//! Divided differences of many instants say little of motions with vibrations or with corners that few steps resolve: the error told was
//! hundreds of times too small. In steps by a tolerance it is the error that confirmed the tolerance. For a method of high order in equal
//! steps, with d the distance between the motion and that in steps of half the length, and d₂ that between the motion and that in steps
//! of twice the length, the error is d/(1 − d/d₂): d₂/d, which is 2ᵖ for short steps, counts as 2 at least. Where it is not half of 2ᵖ, the steps do
//! not resolve the motion.

use crate::control::problem::Simulation;
use crate::dynamics::trajectory::Trajectory;
use crate::dynamics::{
    DiscreteTrajectory, LocalError, OutOfDomain, OutOfRange, STEPS_OF_TOUCH, ShortTouch, Wrinkle,
    distance_between,
};
use crate::math::{shortest, significant};
use crate::nlp::Status;
use crate::workflow::integrate::{Driven, Simulated, grid};
use crate::workflow::tolerance::{EstimatedError, halved, repeated};
use serde::Serialize;

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

/// Orders up to this are estimated from the motion itself.
const LOW: usize = 2;
/// Part of the ratio of short steps that shows their order, and the fewest steps of the coarsest motion in which it does.
const FALLS: f64 = 0.5;
const FEWEST: usize = 6;
/// Least ratio of two distances.
const LEAST: f64 = 2.0;

/// The error of a motion with its `trajectory`, for which the sum of its local errors was estimated.
pub(crate) fn confirmed(
    simulated: &Simulated,
    task: &Simulation,
    trajectory: &Trajectory,
    local: LocalError,
) -> LocalError {
    let is_whole = simulated.failure.is_none();
    // What rests has no error.
    let moves = local.error > 0.0;
    if let Some(known) = simulated.error.filter(|_| moves) {
        return LocalError {
            error: known.place,
            is_resolved: known.is_confirmed,
            ..local
        };
    }
    if local.order <= LOW || task.tolerance.is_some() || !is_whole || !moves {
        return local;
    }
    let found = error(simulated, task, trajectory, local.order);
    let (error, is_resolved) = found.unwrap_or((local.error, false));
    LocalError {
        error,
        is_resolved,
        ..local
    }
}

/// The error in mm, and whether other steps show the order; none where they fail.
fn error(
    simulated: &Simulated,
    task: &Simulation,
    trajectory: &Trajectory,
    order: usize,
) -> Option<(f64, bool)> {
    let (model, discrete) = (&simulated.model, &simulated.discrete);
    let drive = Driven {
        model,
        voltages: &task.voltages,
    };
    let by = |times: &[f64]| repeated(task.solving, model, &drive, discrete, times);
    let halves = by(&halved(&discrete.times))?;
    let of_halves = Trajectory::from_discrete(model, &halves);
    let among = every(2, halves.intervals());
    let last = distance_between(model, (&halves, &of_halves), &among, (discrete, trajectory));
    let pairs = every(2, discrete.intervals());
    let times: Vec<f64> = pairs.iter().map(|&k| discrete.times[k]).collect();
    let before = by(&times).map_or(f64::NAN, |twice| {
        let of_twice = Trajectory::from_discrete(model, &twice);
        distance_between(model, (discrete, trajectory), &pairs, (&twice, &of_twice))
    });
    let of_order = 2.0_f64.powi(i32::try_from(order).ok()?);
    let ratio = (before / last).clamp(LEAST, of_order);
    let ratio = if ratio.is_nan() { LEAST } else { ratio };
    let is_resolved = discrete.intervals() >= 2 * FEWEST && before >= FALLS * of_order * last;
    Some((last / (1.0 - 1.0 / ratio), is_resolved))
}

/// Every so many of the instants of a number of steps, and the last one.
fn every(count: usize, steps: usize) -> Vec<usize> {
    let mut instants: Vec<usize> = (0..steps).step_by(count).collect();
    instants.push(steps);
    instants
}

/// Most muscles and blocks that are written out.
const LISTED: usize = 4;

/// A muscle or block outside the domain of its first-order dielectric.
#[derive(Clone, Debug, Serialize)]
pub struct Outside {
    /// The muscle or block.
    name: String,
    /// Largest stretch.
    stretch: f64,
    /// Stretch beyond which charge and stiffness are negative.
    limit: f64,
    /// First time at which it is outside, in s.
    first: f64,
    /// Time at which the stretch is largest, in s.
    time: f64,
}

/// As `summary.json` has it.
pub(crate) fn outside_domain(list: &[OutOfDomain]) -> Vec<Outside> {
    let outside = |one: &OutOfDomain| Outside {
        name: one.name.clone(),
        stretch: one.stretch,
        limit: one.limit,
        first: one.first / 1e3,
        time: one.time / 1e3,
    };
    list.iter().map(outside).collect()
}

/// One note; with times where there is a motion.
pub(crate) fn domain_note(list: &[Outside], moves: bool) -> Option<String> {
    let one = |out: &Outside| {
        let when = match moves {
            true => format!(" at {:.4} s, outside from {:.4} s on", out.time, out.first),
            false => String::new(),
        };
        format!(
            "{} is stretched to {:.4}{when} (the domain ends at {:.4})",
            out.name, out.stretch, out.limit
        )
    };
    let what = "outside the domain of the first-order dielectric, where charge and stiffness turn negative";
    listed(what, list, one)
}

/// Words on some of a list, and the number of the others; none of an empty one.
fn listed<T>(what: &str, list: &[T], one: impl Fn(&T) -> String) -> Option<String> {
    let named: Vec<String> = list.iter().take(LISTED).map(one).collect();
    let more = match list.len().saturating_sub(LISTED) {
        0 => String::new(),
        more => format!("; and {more} more"),
    };
    (!named.is_empty()).then(|| format!("{what}: {}{more}", named.join("; ")))
}

/// One warning of membranes that are compressed; with times where there is a motion.
pub(crate) fn wrinkle_warning(list: &[Wrinkle], moves: bool) -> Option<String> {
    let one = |of: &Wrinkle| {
        let when = match moves {
            true => format!(" at {:.4} s", of.time / 1e3),
            false => String::new(),
        };
        let [x, y, z] = of.place.into();
        format!(
            "{} by {} kPa{when} around ({x:.3}, {y:.3}, {z:.3}) mm of its reference",
            of.name,
            significant(-of.stress * 1e3, 3)
        )
    };
    let what =
        "membranes are compressed, where they would wrinkle, which their triangles do not show";
    listed(what, list, one)
}

/// One warning of touches that steps do not resolve.
pub(crate) fn short_touch_warning(list: &[ShortTouch]) -> Option<String> {
    let one = |touch: &ShortTouch| {
        let (steps, plural) = (touch.steps, if touch.steps == 1 { "" } else { "s" });
        format!(
            "{} at {:.4} s lasts {steps} step{plural} of {} ms",
            touch.name,
            touch.time / 1e3,
            rounded(touch.duration / steps as f64)
        )
    };
    let what =
        format!("touches of fewer than {STEPS_OF_TOUCH} steps, whose rebound is not resolved");
    listed(&what, list, one)
}

/// One warning; with times where there is a motion.
pub(crate) fn stretch_range_warning(list: &[OutOfRange], moves: bool) -> Option<String> {
    let one = |out: &OutOfRange| {
        let when = match moves {
            true => format!(" at {:.4} s", out.time / 1e3),
            false => String::new(),
        };
        let [low, high] = out.range;
        format!(
            "{} has a stretch of {:.4}{when} (they hold from {low} to {high})",
            out.name, out.stretch
        )
    };
    let what = "outside the range of stretch for which the constants of the material hold";
    listed(what, list, one)
}
