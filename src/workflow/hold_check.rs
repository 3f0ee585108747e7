//! The end of a motion: whether it can be kept, by known values before the solve and by a simulation after it, and whether a periodic one comes back.

use crate::control::problem::{BoundaryState, Control, Hold};
use crate::control::{BoundaryConditions, Rests, Solution};
use crate::dynamics::trajectory::{Trajectory, by_source};
use crate::dynamics::{DiscreteTrajectory, Equilibrium, Start, StepError, simulate};
use crate::math::significant;
use crate::model::{Model, joint_unit};
use crate::stop;
use crate::workflow::error::WorkflowError;
use crate::workflow::motion::{Distance, solved, trajectory};
use crate::workflow::resimulate::{Held, Resimulation, held, is_small};
use serde::Serialize;
use std::ops::ControlFlow;

/// Refuses an end that has to be held and is known not to be: its voltages are not known, or beyond their bounds, or the
/// goal is unstable under them.
///
/// # Errors
/// Place and reason.
pub(crate) fn check(
    control: &Control,
    model: &Model,
    boundary: &BoundaryConditions,
) -> Result<(), WorkflowError> {
    if control.hold == Hold::Reported || control.seeks_hold() {
        return Ok(());
    }
    let refused =
        |key: &str, reason: String| Err(WorkflowError::problem(format!("control.{key}"), reason));
    if boundary.rest[1].is_none() {
        let reason = "the final state must be held, but the goal names no voltages that hold it: take \"rest_at_voltages\", \
                      \"markers\" with \"hold\", or either of \"markers\" and \"joint_angles\" with \"hold\": \"find\"";
        return refused("goal", reason.to_owned());
    }
    if let Some((name, reason)) = beyond_bounds(control, model) {
        return refused(&format!("goal.hold.{name}"), reason);
    }
    match unstable(boundary) {
        Some(reason) => {
            let reason = format!("the final state must be held, but {reason}");
            refused("goal", reason)
        }
        None => Ok(()),
    }
}

/// Returns the reason why the end of an optimum is not kept, in a line; nothing where it is, or where no voltages are known to keep it.
pub(crate) fn warning(
    control: &Control,
    model: &Model,
    boundary: &BoundaryConditions,
    resimulation: Option<&Resimulation>,
) -> Option<String> {
    let beyond = beyond_bounds(control, model).map(|(name, reason)| format!("{name}: {reason}"));
    let mut reasons: Vec<String> = beyond.into_iter().chain(unstable(boundary)).collect();
    if let Some(tested) = resimulation
        && let (Some(held), Some(drift)) = (tested.held, tested.drift)
        && !tested.is_held(model)
    {
        reasons.push(match &tested.failure {
            Some(failure) => format!("under the held inputs the motion ends early: {failure}"),
            None => format!("under the held inputs it moves by {drift} in {held} s"),
        });
    }
    (!reasons.is_empty()).then(|| format!("the goal cannot be kept: {}", reasons.join("; ")))
}

/// Note that the continuation of a motion with a free end is not known.
pub(crate) fn free_end(control: &Control) -> Option<String> {
    let is_end = control.goal == BoundaryState::Free && !control.continues[1];
    is_end.then(|| {
        "the end is free: the motion need not come to rest there, and what follows it is not verified".to_owned()
    })
}

/// The first source that is sought and held at a voltage that it may not have, and why not.
fn beyond_bounds(control: &Control, model: &Model) -> Option<(String, String)> {
    let BoundaryState::Markers {
        hold: Some(hold), ..
    } = &control.goal
    else {
        return None;
    };
    let [lower, upper] = control.voltage_bounds;
    let mut held = model.sources.iter().zip(hold).enumerate();
    held.find_map(|(s, (source, &voltage))| {
        let is_beyond = voltage < lower || voltage > upper;
        let is_sought = source.takes_voltage && !control.is_given(s);
        (is_beyond && is_sought).then(|| {
            let reason =
                format!("a hold of {voltage} V is beyond the bounds {lower} V to {upper} V");
            (source.name.clone(), reason)
        })
    })
}

/// That the goal is an unstable equilibrium, where it is.
fn unstable(boundary: &BoundaryConditions) -> Option<String> {
    let rest = boundary.goal.rest.as_ref()?;
    if rest.is_stable() != Some(false) {
        return None;
    }
    let softest = rest.stiffness.first().map_or(String::new(), |value| {
        format!(", the stiffness of its softest mode is {value:.3e} N mm/rad")
    });
    // An indifferent equilibrium, as of a cart that nothing holds, is kept where it is.
    let count = match rest.stiffness.is_empty() {
        true => rest.unstable.unwrap_or(1),
        false => rest.stiffness.iter().filter(|value| **value < 0.0).count(),
    };
    if count == 0 {
        return None;
    }
    let plural = if count == 1 { "" } else { "s" };
    Some(format!(
        "it is an unstable equilibrium, in {count} direction{plural}{softest}"
    ))
}

/// A part of the largest input that holds a goal; smaller ones are not named.
const HARDLY: f64 = 1e-3;

/// Makes the goal of a motion the state of rest that it is, under the inputs that were found with it or that the goal names.
///
/// Its stability is known where the coordinates are free of constraints.
pub(crate) fn keep_found(
    model: &Model,
    boundary: &mut BoundaryConditions,
    motion: &DiscreteTrajectory,
) {
    let Some(z) = motion.z.last() else {
        return;
    };
    let held = match &motion.held {
        Some(found) => {
            boundary.rest[1] = Some(by_source(model, found));
            found.clone()
        }
        None => match named(model, boundary) {
            Some(named) => named,
            None => return,
        },
    };
    if model.action.map.multipliers == 0 {
        boundary.goal.rest = Some(Equilibrium::of_state(model, z, &held));
    }
}

/// Scalars of an interval with the inputs under which all of the system rests at a goal whose state was found; none where potentials follow from
/// them, or the goal was known to be an equilibrium.
fn named(model: &Model, boundary: &BoundaryConditions) -> Option<Vec<f64>> {
    let goal = &boundary.goal;
    let is_open = goal.rest.is_none() && goal.rests == Rests::Everything;
    let inputs = boundary.rest[1].as_ref().filter(|_| is_open)?;
    let scalars = model.variables.scalars(&model.scalars(inputs));
    let [_, others] = model.variables.split(&scalars);
    others.is_empty().then_some(scalars)
}

/// Names the inputs that were found and hold the goal, without those that are hardly any.
pub(crate) fn note_found(model: &Model, held: &[f64]) -> String {
    let all = || {
        let all = model.sources.iter().zip(held);
        all.map(|(source, value)| {
            let (unit, size) = source.kind.counted();
            (&source.name, value / size, unit)
        })
    };
    let largest = all().fold(0.0, |most: f64, (_, value, _)| most.max(value.abs()));
    let named = all().filter(|(_, value, _)| value.abs() > HARDLY * largest);
    let named = named.map(|(name, value, unit)| format!("{name} {} {unit}", significant(value, 4)));
    let named: Vec<String> = named.collect();
    match named.is_empty() {
        true => "the goal was found to be held without any voltage or load".to_owned(),
        false => format!(
            "the goal is held by inputs that were found with the motion: {}",
            named.join(", ")
        ),
    }
}

/// Maximum number of parts of the goal listed.
const TOLD: usize = 3;

/// The motion after the goal, under the voltages of the last interval.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Afterwards {
    /// Time that was simulated in s.
    pub seconds: f64,
    /// Departure from each part of the goal, the farthest first.
    pub goal: Vec<Departure>,
    /// Greatest drift of the system from the last optimal instant.
    pub drift: Distance,
    /// Reason why the simulation ended early.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub failure: Option<String>,
    /// True if the system stays at its goal.
    pub is_held: bool,
}

/// Departure from a part of a goal.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Departure {
    /// The marker or the joint.
    pub name: String,
    /// Greatest deviation from the goal.
    pub deviation: f64,
    /// Unit of the deviation: m or rad.
    pub unit: &'static str,
    /// Time at which it is greatest, in s after the end.
    pub time: f64,
}

/// Simulates on from the end of a motion, with the length of its path, to a goal that names places or joint coordinates and no voltages that hold it.
pub(crate) fn afterwards(
    model: &Model,
    control: &Control,
    optimal: &Solution,
    path_length: Distance,
) -> Option<Afterwards> {
    let is_named = control.names_no_hold() && !control.seeks_hold();
    let n = optimal.intervals();
    let end = Start {
        z: optimal.z.get(n)?.clone(),
        momentum: optimal.momentum.clone(),
        rates: None,
        time: *optimal.times.get(n)?,
    };
    let last = optimal.voltages.last()?;
    if !is_named || end.momentum.len() != model.coordinate_count() {
        return None;
    }
    let Held {
        motion,
        drift,
        failure,
    } = held(model, &end, optimal, last);
    Some(Afterwards {
        seconds: motion.times[motion.intervals()] / 1e3,
        goal: departures(model, &control.goal, &trajectory(model, &motion)),
        is_held: failure.is_none() && is_small(drift, path_length, model),
        drift,
        failure: failure.map(|error| error.to_string()),
    })
}

/// Returns the departures from the parts of a goal along a motion that begins there.
fn departures(model: &Model, goal: &BoundaryState, motion: &Trajectory) -> Vec<Departure> {
    let system = &model.system;
    let farthest = |name: &str, unit: &'static str, far: &dyn Fn(usize) -> f64| {
        let instants = 0..motion.times.len();
        let each = instants.map(|k| (far(k), motion.times[k] / 1e3));
        let (deviation, time) = each.fold((0.0, 0.0), |a, b| if b.0 > a.0 { b } else { a });
        Departure {
            name: name.to_owned(),
            deviation,
            unit,
            time,
        }
    };
    let mut list: Vec<Departure> = match goal {
        BoundaryState::Markers { places, .. } => {
            let all = places.iter();
            all.map(|(&m, place)| {
                let far = |k: usize| place.distance(&motion.marks[k][m]) / 1e3;
                farthest(&system.markers[m].name, "m", &far)
            })
            .collect()
        }
        BoundaryState::JointAngles { angles, .. } => {
            let all = angles.iter();
            all.map(|(&j, &value)| {
                let before = system.joints[..j].iter();
                let column = before.filter(|joint| joint.has_coordinate()).count();
                let (unit, scale) = match joint_unit(system, j) {
                    "mm" => ("m", 1e-3),
                    unit => (unit, 1.0),
                };
                let far = |k: usize| (motion.joints[k][column] - value).abs() * scale;
                farthest(&system.joints[j].name, unit, &far)
            })
            .collect()
        }
        _ => Vec::new(),
    };
    list.sort_by(|a, b| b.deviation.total_cmp(&a.deviation));
    list
}

impl Departure {
    /// In words, lengths in mm and angles in degrees.
    fn message(&self) -> String {
        let Self { name, time, .. } = self;
        let far = match self.unit {
            "m" => format!("{} mm", significant(1e3 * self.deviation, 3)),
            _ => format!("{}°", significant(self.deviation.to_degrees(), 3)),
        };
        format!(
            "{name} is up to {far} from its goal ({} s after the end)",
            significant(*time, 2)
        )
    }
}

impl Afterwards {
    /// That nothing holds the goal, where it is left; with the advice to seek inputs that hold it where these `can_be_sought`.
    pub(crate) fn warning(&self, can_be_sought: bool) -> Option<String> {
        if self.is_held {
            return None;
        }
        let far = self.goal.iter().take(TOLD).map(Departure::message);
        let early = self.failure.iter();
        let early = early.map(|failure| format!("the motion ends early: {failure}"));
        let moves = format!("the system moves by {}", self.drift);
        let far: Vec<String> = far.chain([moves]).chain(early).collect();
        let advice = match can_be_sought {
            false => "\"rest_at_voltages\", or \"markers\" with \"hold\"",
            true => {
                "\"rest_at_voltages\", \"markers\" with \"hold\", or \"hold\": \"find\", which seeks the voltages of markers and joint angles"
            }
        };
        Some(format!(
            "nothing holds the goal: with the last inputs held on for {} s, {}; for an end that stays take {advice}",
            significant(self.seconds, 3),
            far.join(", ")
        ))
    }
}

/// Periods that are simulated.
const PERIODS: usize = 5;

/// The motion under the inputs of a periodic one, again and again.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Repeated {
    /// Number of periods that were simulated.
    pub periods: usize,
    /// Greatest distance from the same instant of the periodic motion.
    pub drift: Distance,
    /// Reason why the simulation ended early.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub failure: Option<String>,
    /// True if the motion comes back in every period.
    pub comes_back: bool,
}

/// Starts a motion where it was found to start, with momenta and inputs of the end of the motion `before` it: a periodic one comes before itself.
pub(crate) fn begin(
    control: &Control,
    boundary: &mut BoundaryConditions,
    motion: &Solution,
    before: Option<&Solution>,
) {
    let itself = (control.goal == BoundaryState::Periodic).then_some(motion);
    let Some(before) = before.or(itself) else {
        return;
    };
    boundary.start = Start {
        z: motion.z[0].clone(),
        momentum: before.momentum.clone(),
        rates: None,
        time: 0.0,
    };
    boundary.rest[0] = before.voltages.last().cloned();
}

/// Simulates the inputs of a periodic motion again and again, with its step, and compares the drift with the length of its path; nothing
/// where joints have motions of their own, or a stop ends the first period.
pub(crate) fn repeated(
    model: &Model,
    control: &Control,
    start: &Start,
    optimal: &Solution,
    path_length: Distance,
) -> Option<Repeated> {
    // Prescribed motions go on as functions of time.
    if control.goal != BoundaryState::Periodic || !model.prescribed.is_empty() {
        return None;
    }
    let n = optimal.intervals();
    let h = optimal.times[n] / n as f64;
    let scalars = |from: f64, to: f64| {
        let k = (0.5 * (from + to) / h) as usize % n;
        model.scalars(&optimal.voltages[k])
    };
    let go_on = |_: &_| stop::check().map_or(ControlFlow::Break(()), ControlFlow::Continue);
    let (discrete, failure) = simulate(model, start, h, PERIODS * n, scalars, go_on);
    let failure = failure.filter(|error| !matches!(error, StepError::Stopped { .. }));
    let motion = solved(model, &discrete, None);
    // A stop within the first period leaves nothing to say.
    if failure.is_none() && motion.intervals() < n {
        return None;
    }
    let of = |k: usize| Distance::between(model, &motion, k, optimal, k % n);
    let drift = (0..motion.times.len()).map(of);
    let drift = drift.fold(Distance::default(), Distance::max);
    Some(Repeated {
        periods: motion.intervals() / n,
        drift,
        comes_back: failure.is_none() && is_small(drift, path_length, model),
        failure: failure.map(|error| error.to_string()),
    })
}

impl Repeated {
    /// That the motion comes back.
    pub(crate) fn note(&self) -> Option<String> {
        let Self { periods, drift, .. } = self;
        self.comes_back.then(|| {
            format!("the motion is periodic: after {periods} periods under the same inputs the state has drifted by {drift}")
        })
    }

    /// That it does not.
    pub(crate) fn warning(&self) -> Option<String> {
        let Self { periods, drift, .. } = self;
        let early = self.failure.as_ref();
        let early = early.map_or(String::new(), |failure| {
            format!(", and ends early: {failure}")
        });
        (!self.comes_back).then(|| {
            format!(
                "the periodic motion is not stable: after {} periods under the same inputs the state has drifted by {drift}{early}",
                significant(*periods as f64, 3)
            )
        })
    }
}
