//! The motion of a simulation under a controller, compared with that which the controller follows.

use crate::dynamics::DiscreteTrajectory;
use crate::dynamics::trajectory::Trajectory;
use crate::feedback::Law;
use crate::model::{Model, Role};
use crate::workflow::control_loop::{Counts, Plans};
use crate::workflow::loop_limits::LoopLimits;
use crate::workflow::receding::Source;
use crate::workflow::tracking::Tracked;
use serde::Serialize;
use std::collections::BTreeMap;

/// The motion under a controller, and without its corrections, compared with that of the law.
#[derive(Clone, Debug, PartialEq, Serialize)]
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
            limits: None,
            markers: BTreeMap::new(),
            joints: BTreeMap::new(),
            tracked: Vec::new(),
            tracked_open: Vec::new(),
            open_loop_failure,
            open_loop: None,
            disturbance: Vec::new(),
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
            let of = (model, discrete, &open_loop);
            out.take_joints(of, [&motion, &open], &law);
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
        (model, discrete, without): (&Model, &DiscreteTrajectory, &DiscreteTrajectory),
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
            let [tracked, open] = [of(discrete, motions[0]), of(without, motions[1])];
            let deviations = self.take(tracked, open, motions, law);
            self.joints.insert(name.clone(), deviations);
        }
    }

    /// Deviations of what is tracked.
    fn of(&self, tracked: &Tracked) -> &Deviations {
        let all = if tracked.kind == "marker" {
            &self.markers
        } else {
            &self.joints
        };
        &all[&tracked.name]
    }

    /// One line for each marker, or for each joint of a robot without markers.
    pub fn notes(&self) -> Vec<String> {
        let told = |of: &Deviation, tracked: &Tracked| {
            let held = of.greatest_held;
            let held = held
                .map(|held| format!(", {} after the end of the reference", plain(held, tracked)));
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
        let others = plans
            .sources
            .iter()
            .filter(|(word, _)| **word != Source::Plan.word());
        let others: Vec<String> = others
            .map(|(word, count)| format!("{word:?} in {count}"))
            .collect();
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
        let along = tracked
            .paths
            .iter()
            .map(|path| path.reference[k] - path.reference[k - 1]);
        along.map(|step| step * step).sum::<f64>().sqrt()
    };
    (1..tracked.deviation.len()).map(step).sum()
}
