//! The motion of a simulation under a controller, compared with that which the controller follows.
//!
//! The path limits of a problem along a simulated motion: of a robot under a controller that plans anew, or under the inputs of an optimum.
//!
//! A program keeps them at its own instants and intervals, a plan for the robot that it knows, as it was measured; the motion in finer steps, of
//! another robot, or under a push, may pass them. All limits are compared that the model of the simulated robot tells.

use crate::control::problem::{Ahead, Control, Simulation};
use crate::control::{LimitsAlong, PassedLimit, limits_along};
use crate::dynamics::DiscreteTrajectory;
use crate::dynamics::trajectory::Trajectory;
use crate::feedback::Law;
use crate::math::significant;
use crate::model::{Analysis, Model, Role, System};
use crate::workflow::control_loop::{Counts, Plans};
use crate::workflow::error::WorkflowError;
use crate::workflow::integrate::grid;
use crate::workflow::optimum::Optimum;
use crate::workflow::receding::Source;
use crate::workflow::remark::Remarks;
use crate::workflow::tracking::Tracked;
use serde::Serialize;
use std::collections::{BTreeMap, BTreeSet};

/// The motion under a controller, and without its corrections, compared with that of the law.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct ClosedLoop {
    /// Number of samples.
    pub samples: usize,
    /// Number of samples with an input at its lower bound, below which gains wanted it: a muscle cannot push. Of plans, within 1e-4 of the range, of
    /// squares of voltages.
    pub samples_at_lower_bound: usize,
    /// Number of samples with an input at its upper bound, above which gains wanted it; of plans as below.
    pub samples_at_upper_bound: usize,
    /// Steps of a controller that plans anew.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub plans: Option<Plans>,
    /// The path limits of the problem that is planned anew; absent where it has none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub limits: Option<LoopLimits>,
    /// Deviations of markers, by name.
    pub markers: BTreeMap<String, Deviations>,
    /// Deviations of the coordinates of joints, by name, of a robot without markers.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub joints: BTreeMap<String, Deviations>,
    /// Reason why the motion without corrections ended early.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub open_loop_failure: Option<String>,
    /// Markers, or the coordinates of joints, next to their places in the motion of the law.
    #[serde(skip)]
    pub tracked: Vec<Tracked>,
    /// The same of the motion without corrections.
    #[serde(skip)]
    pub tracked_open: Vec<Tracked>,
    /// The motion without corrections.
    #[serde(skip)]
    pub open_loop: Option<Trajectory>,
    /// Deviations with parts of the disturbance, where they were simulated.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub disturbance: Vec<PartOfDisturbance>,
}

/// Deviations with a part of the disturbance.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PartOfDisturbance {
    /// The part.
    pub size: f64,
    /// Deviations of markers, by name.
    pub markers: BTreeMap<String, Deviations>,
    /// Of the coordinates of joints, of a robot without markers.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub joints: BTreeMap<String, Deviations>,
}

/// A closed loop with a part of the disturbance.
#[derive(Clone, Debug, PartialEq)]
pub struct DisturbedLoop {
    /// The part.
    pub size: f64,
    /// Instants of the motion in ms.
    pub times: Vec<f64>,
    /// The motion next to that of the controller.
    pub closed: ClosedLoop,
}

impl DisturbedLoop {
    /// The part that is the problem itself.
    pub(crate) const WHOLE: f64 = 1.0;

    /// Its numbers for a summary.
    pub fn report(&self) -> PartOfDisturbance {
        PartOfDisturbance {
            size: self.size,
            markers: self.closed.markers.clone(),
            joints: self.closed.joints.clone(),
        }
    }
}

/// Part of its path by which a marker or coordinate may be beside its goal without a warning.
const MISSED: f64 = 0.1;
/// Least path, as a part of the length of the system, or in rad.
const STILL: f64 = 0.05;

/// Distances of a marker or coordinate from its place in the motion of a law, in m or rad.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Deviations {
    /// With feedback.
    pub feedback: Deviation,
    /// Without corrections; absent where that motion ended early.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub open_loop: Option<Deviation>,
}

/// Distances of a marker in a motion.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Deviation {
    /// The greatest.
    pub greatest: f64,
    /// The greatest after the end of the motion of the law; absent where the simulation ends before.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub greatest_held: Option<f64>,
    /// That at the last instant.
    pub last: f64,
}

impl Deviation {
    /// Of what is tracked at times in ms, greatest also from another one on.
    fn new(times: &[f64], tracked: &Tracked, end: f64) -> Self {
        let mut out = Self::default();
        for (&time, deviation) in times.iter().zip(&tracked.deviation) {
            out.last = deviation * scale(tracked);
            out.greatest = out.greatest.max(out.last);
            if time >= end * (1.0 - 1e-9) {
                let before = out.greatest_held.unwrap_or(0.0);
                out.greatest_held = Some(out.last.max(before));
            }
        }
        out
    }
}

impl ClosedLoop {
    /// The comparison of a motion, and of one without corrections, with that of the law.
    pub(crate) fn new(
        model: &Model,
        counts: Counts,
        discrete: &DiscreteTrajectory,
        open_loop: (DiscreteTrajectory, Option<String>),
    ) -> Self {
        let (open_loop, open_loop_failure) = open_loop;
        let Counts {
            samples: [samples, samples_at_lower_bound, samples_at_upper_bound],
            plans,
            law,
        } = counts;
        let [motion, open] = [discrete, &open_loop].map(|of| Trajectory::from_discrete(model, of));
        let mut out = Self {
            samples,
            samples_at_lower_bound,
            samples_at_upper_bound,
            plans,
            open_loop_failure,
            ..Self::default()
        };
        for (name, places) in &law.markers {
            let all = &model.system.markers;
            let Some(marker) = all.iter().position(|marker| marker.name == *name) else {
                continue;
            };
            let of = |motion: &Trajectory| {
                let places = motion.times.iter().map(|&time| law.place(places, time));
                let places: Vec<[f64; 3]> = places.collect();
                Tracked::marker(name, marker, motion, &places)
            };
            let deviations = out.take(of(&motion), of(&open), [&motion, &open], &law);
            out.markers.insert(name.clone(), deviations);
        }
        if out.markers.is_empty() {
            out.take_joints(model, [discrete, &open_loop], [&motion, &open], &law);
        }
        out.open_loop = Some(open);
        out
    }

    /// Takes what is tracked in a motion, and in the one without corrections.
    fn take(
        &mut self,
        tracked: Tracked,
        without: Tracked,
        [motion, open]: [&Trajectory; 2],
        law: &Law,
    ) -> Deviations {
        let of = |motion: &Trajectory, tracked: &Tracked| {
            Deviation::new(&motion.times, tracked, law.duration())
        };
        let is_whole = self.open_loop_failure.is_none();
        let out = Deviations {
            feedback: of(motion, &tracked),
            open_loop: is_whole.then(|| of(open, &without)),
        };
        self.tracked.push(tracked);
        self.tracked_open.push(without);
        out
    }

    /// Takes the coordinates of joints that the law knows.
    fn take_joints(
        &mut self,
        model: &Model,
        unknowns: [&DiscreteTrajectory; 2],
        motions: [&Trajectory; 2],
        law: &Law,
    ) {
        let coordinates = model.variables.with(Role::Coordinate);
        for (place, measured) in law.measured.iter().enumerate() {
            let own = coordinates.iter().position(|one| one.name == measured.name);
            let own = own.filter(|_| !measured.is_rate && measured.memory.is_none());
            let Some(i) = own else { continue };
            let mut readings = model.joint_readings.iter();
            let joint = readings.position(|one| one.coordinate == Some(i));
            let name = joint.map_or(&measured.name, |joint| &model.system.joints[joint].name);
            let of = |discrete: &DiscreteTrajectory, motion: &Trajectory| {
                let value = discrete.z.iter().map(|z| z[i]).collect();
                let times = motion.times.iter();
                let reference = times.map(|&time| law.reference(time, place)).collect();
                let values = [value, reference];
                Tracked::coordinate(name, measured.is_length, &motion.times, values)
            };
            let [tracked, open] = [0, 1].map(|i| of(unknowns[i], motions[i]));
            let deviations = self.take(tracked, open, motions, law);
            self.joints.insert(name.clone(), deviations);
        }
    }

    /// Deviations of what is tracked.
    fn of(&self, tracked: &Tracked) -> &Deviations {
        match tracked.kind {
            "marker" => &self.markers[&tracked.name],
            _ => &self.joints[&tracked.name],
        }
    }

    /// One line for each marker, or for each joint of a robot without markers.
    pub fn notes(&self) -> Vec<String> {
        let told = |of: &Deviation, tracked: &Tracked| {
            let held = of.greatest_held.map(|held| plain(held, tracked));
            let held = held.map(|held| format!(", {held} after the end of the reference"));
            format!(
                "at most {} from the reference{}, {} at the end",
                plain(of.greatest, tracked),
                held.unwrap_or_default(),
                plain(of.last, tracked)
            )
        };
        let line = |tracked: &Tracked| {
            let of = self.of(tracked);
            let open = match &of.open_loop {
                Some(open) => format!("; without feedback {}", told(open, tracked)),
                None => "; without feedback the motion ends early".to_owned(),
            };
            format!("{}: {}{open}", tracked.name, told(&of.feedback, tracked))
        };
        let mut all: Vec<&Tracked> = self.tracked.iter().collect();
        all.sort_by_key(|tracked| &tracked.name);
        all.into_iter().map(line).collect()
    }

    /// Warnings of markers, or of joints, that are far from their goal at the end of a simulation which lasts longer than the motion; `length` of the system in mm.
    pub fn missed(&self, length: f64) -> Vec<String> {
        let line = |tracked: &Tracked| {
            let of = &self.of(tracked).feedback;
            let last = of.greatest_held.map(|_| of.last)?;
            let size = if tracked.unit == "m" { length } else { 1.0 };
            let path = path_length(tracked).max(STILL * size) * scale(tracked);
            (last > MISSED * path).then(|| {
                format!(
                    "under the controller {} is {} from its goal at the end, {:.0} % of its path",
                    tracked.name,
                    plain(last, tracked),
                    100.0 * last / path
                )
            })
        };
        self.tracked.iter().filter_map(line).collect()
    }

    /// That the motion without corrections ends early, so that there is nothing to compare with.
    pub fn open_loop_early(&self) -> Option<String> {
        let reason = self.open_loop_failure.as_ref()?;
        Some(format!(
            "the motion without feedback, for comparison, ends early: {reason}"
        ))
    }

    /// That inputs of a controller that plans anew came from elsewhere than from its plan with what was measured.
    pub fn other_sources(&self) -> Option<String> {
        let plans = self.plans.as_ref()?;
        let others = plans.sources.iter();
        let others = others.filter(|(word, _)| **word != Source::Plan.word());
        let others = others.map(|(word, count)| format!("{word:?} in {count}"));
        let others: Vec<String> = others.collect();
        (!others.is_empty()).then(|| {
            format!(
                "the plan of the controller did not give the inputs of all {} samples: {}",
                self.samples,
                others.join(", ")
            )
        })
    }

    /// That inputs of gains came to their lower bounds; those of plans know the bounds.
    pub fn at_lower_bound(&self) -> Option<String> {
        let (count, samples) = (self.samples_at_lower_bound, self.samples);
        (count > 0 && self.plans.is_none()).then(|| {
            format!(
                "the controller saturated at the lower bound of an input in {count} of {samples} samples: a muscle cannot push"
            )
        })
    }

    /// A warning of inputs of gains at their upper bounds.
    pub fn at_upper_bound(&self) -> Option<String> {
        let (count, samples) = (self.samples_at_upper_bound, self.samples);
        (count > 0 && self.plans.is_none()).then(|| {
            format!("in {count} of {samples} samples the controller wanted an input above its upper bound")
        })
    }
}

/// m in a mm; of angles, nothing changes.
fn scale(of: &Tracked) -> f64 {
    if of.unit == "m" { 1e-3 } else { 1.0 }
}

/// A deviation in m or rad, in words.
fn plain(value: f64, of: &Tracked) -> String {
    match of.unit {
        "m" => format!("{:.3} mm", 1e3 * value),
        _ => format!("{value:.5} rad"),
    }
}

/// Length in mm or rad of the path of what is tracked in the motion of the law.
fn path_length(tracked: &Tracked) -> f64 {
    let step = |k: usize| {
        let along = tracked.paths.iter().map(|path| &path.reference);
        let along = along.map(|reference| reference[k] - reference[k - 1]);
        along.map(|step| step * step).sum::<f64>().sqrt()
    };
    (1..tracked.deviation.len()).map(step).sum()
}

/// A part of the larger bound by which a limit may be passed without a warning: that of steps of finite length.
const SLIGHT: f64 = 1e-3;
/// The same of an optimum, of which the intervals are longer.
const BETWEEN: f64 = 0.02;

/// Limits along a simulated motion.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LoopLimits {
    /// Names of those that were compared.
    pub compared: Vec<String>,
    /// Names of those that the simulated robot does not tell.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub not_compared: Vec<String>,
    /// Those that are passed, the one that is passed most in front.
    pub passed: Vec<Passed>,
}

/// A limit that is passed, where that is most.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Passed {
    /// Its name.
    pub limit: String,
    /// Distance to the bound.
    pub excess: f64,
    /// Value and bound, in the same unit.
    pub value: f64,
    /// The bound.
    pub bound: f64,
    /// The unit; absent of a pure number.
    #[serde(skip_serializing_if = "str::is_empty")]
    pub unit: &'static str,
    /// Instant in s.
    pub time: f64,
    /// True if it is passed by more than steps of finite length explain.
    #[serde(skip)]
    is_far: bool,
}

impl LoopLimits {
    /// Those of a problem along a motion of the robot that is simulated; none where it has none.
    ///
    /// # Errors
    /// There is no model of the robot that measures them.
    pub(crate) fn new(
        of: &Ahead,
        system: &System,
        task: &Simulation,
        motion: &DiscreteTrajectory,
    ) -> Result<Option<Self>, WorkflowError> {
        let limits = &of.control.limits;
        if limits.is_empty() {
            return Ok(None);
        }
        let analysis = task.analysis(system, grid(task).1);
        let found = limits_along(&of.system, limits, system, analysis, motion);
        let found = found.map_err(|error| WorkflowError::boundary("simulate", &error.into()))?;
        Ok(Some(Self::of(found, SLIGHT)))
    }

    /// Those of a problem along the motion under the inputs of its optimum in steps of half the length; none where it has none.
    pub(crate) fn of_optimum(control: &Control, optimum: &Optimum) -> Option<Self> {
        let motion = optimum.resimulation.as_ref()?.half.as_ref()?;
        if control.limits.is_empty() {
            return None;
        }
        let system = &optimum.model.system;
        let analysis = Analysis {
            interval: motion.times[1] - motion.times[0],
            curved: BTreeSet::new(),
            ..optimum.model.analysis.clone()
        };
        let found = limits_along(system, &control.limits, system, analysis, motion);
        found.ok().map(|found| Self::of(found, BETWEEN))
    }

    fn of(mut found: LimitsAlong, slight: f64) -> Self {
        found.passed.sort_by(|a, b| b.part.total_cmp(&a.part));
        let passed = |one: PassedLimit| Passed {
            excess: (one.value - one.bound).abs(),
            limit: one.name,
            value: one.value,
            bound: one.bound,
            unit: one.unit,
            time: one.time / 1e3,
            is_far: one.part > slight,
        };
        Self {
            compared: found.compared,
            not_compared: found.left_out,
            passed: found.passed.into_iter().map(passed).collect(),
        }
    }

    /// Adds a warning of limits that are passed, a note where steps of finite length explain it, and one of limits that are not compared.
    pub(crate) fn remark(&self, remarks: &mut Remarks) {
        let message = self.message("under the controller");
        match self.is_far() {
            true => remarks.warn("limit_passed", message),
            false => remarks.note("limit_passed", message),
        }
        let names = &self.not_compared;
        let not_compared = (!names.is_empty()).then(|| {
            format!(
                "limits that the simulated robot does not tell are not compared with its motion: {}",
                names.join(", ")
            )
        });
        remarks.note("limits_not_compared", not_compared);
    }

    /// The warning of an optimum whose motion in finer steps passes a limit by far.
    pub(crate) fn warning(&self) -> Option<String> {
        let message = self.message("under the optimal inputs, in steps of half the length,");
        message.filter(|_| self.is_far())
    }

    fn is_far(&self) -> bool {
        self.passed.first().is_some_and(|worst| worst.is_far)
    }

    fn message(&self, when: &str) -> Option<String> {
        let worst = self.passed.first()?;
        let space = if worst.unit.is_empty() { "" } else { " " };
        let number = |value: f64| format!("{}{space}{}", significant(value, 4), worst.unit);
        let others = match self.passed.len() - 1 {
            0 => String::new(),
            1 => "; another limit is passed too".to_owned(),
            others => format!("; {others} other limits are passed too"),
        };
        Some(format!(
            "{when} a limit is passed, {}: {} at {} s, {} beyond its bound {}{others}",
            worst.limit,
            number(worst.value),
            worst.time,
            number(worst.excess),
            number(worst.bound),
        ))
    }
}
