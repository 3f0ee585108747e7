//! The motion of a simulation under a controller, compared with that which the controller follows.

use crate::dynamics::DiscreteTrajectory;
use crate::dynamics::trajectory::Trajectory;
use crate::model::Model;
use crate::workflow::control_loop::{Counts, Plans};
use crate::workflow::receding::Source;
use crate::workflow::tracking::Tracked;
use serde::Serialize;
use std::collections::BTreeMap;

/// The motion under a controller, and without its corrections, compared with that of the law.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ClosedLoop {
    /// Number of samples.
    pub samples: usize,
    /// Number of samples with an input at its lower bound, below which it was wanted: a muscle can not push.
    pub samples_at_lower_bound: usize,
    /// Number of samples with an input at its upper bound, above which it was wanted.
    pub samples_at_upper_bound: usize,
    /// Steps of a controller that plans anew.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub plans: Option<Plans>,
    /// Deviations of markers, by name.
    pub markers: BTreeMap<String, Deviations>,
    /// Reason why the motion without corrections ended early.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub open_loop_failure: Option<String>,
    /// Markers next to their places in the motion of the law.
    #[serde(skip)]
    pub tracked: Vec<Tracked>,
    /// The motion without corrections.
    #[serde(skip)]
    pub open_loop: Option<Trajectory>,
}

/// Part of its path by which a marker may be beside its goal without a warning.
const MISSED: f64 = 0.1;
/// Least path, as a part of the length of the system.
const STILL: f64 = 0.05;

/// Distances of a marker from its place in the motion of a law, in m.
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
    /// Of a marker at times in ms, greatest also from another one on.
    fn new(times: &[f64], tracked: &Tracked, end: f64) -> Self {
        let mut out = Self::default();
        for (&time, deviation) in times.iter().zip(&tracked.deviation) {
            out.last = deviation / 1e3;
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
            markers: BTreeMap::new(),
            tracked: Vec::new(),
            open_loop_failure,
            open_loop: None,
        };
        for (name, places) in &law.markers {
            let all = &model.system.markers;
            let Some(marker) = all.iter().position(|marker| marker.name == *name) else {
                continue;
            };
            let of = |motion: &Trajectory| {
                let places = motion.times.iter().map(|&time| law.place(places, time));
                let places: Vec<[f64; 3]> = places.collect();
                let tracked = Tracked::marker(name, marker, motion, &places);
                let deviation = Deviation::new(&motion.times, &tracked, law.duration());
                (tracked, deviation)
            };
            let (tracked, feedback) = of(&motion);
            let is_whole = out.open_loop_failure.is_none();
            let open_loop = is_whole.then(|| of(&open).1);
            out.tracked.push(tracked);
            let deviations = Deviations {
                feedback,
                open_loop,
            };
            out.markers.insert(name.clone(), deviations);
        }
        out.open_loop = Some(open);
        out
    }

    /// One line a marker.
    pub fn notes(&self) -> Vec<String> {
        let millimetres = |of: &Deviation| {
            let held = of
                .greatest_held
                .map(|held| format!(", {:.3} mm after the end of the reference", 1e3 * held));
            format!(
                "at most {:.3} mm from the reference{}, {:.3} mm at the end",
                1e3 * of.greatest,
                held.unwrap_or_default(),
                1e3 * of.last
            )
        };
        let line = |(name, of): (&String, &Deviations)| {
            let open = match &of.open_loop {
                Some(open) => format!("; without feedback {}", millimetres(open)),
                None => "; without feedback the motion ends early".to_owned(),
            };
            format!("{name}: {}{open}", millimetres(&of.feedback))
        };
        self.markers.iter().map(line).collect()
    }

    /// Warnings of markers that are far from their goal at the end of a simulation which lasts longer than the motion; `length` of the system in mm.
    pub fn missed(&self, length: f64) -> Vec<String> {
        let line = |tracked: &Tracked| {
            let of = &self.markers[&tracked.name].feedback;
            let last = of.greatest_held.map(|_| of.last)?;
            let path = path_length(tracked).max(STILL * length) / 1e3;
            (last > MISSED * path).then(|| {
                format!(
                    "under the controller {} is {:.3} mm from its goal at the end, {:.0} % of its path",
                    tracked.name,
                    1e3 * last,
                    100.0 * last / path
                )
            })
        };
        self.tracked.iter().filter_map(line).collect()
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

    /// That inputs came to their lower bounds.
    pub fn at_lower_bound(&self) -> Option<String> {
        let (count, samples) = (self.samples_at_lower_bound, self.samples);
        (count > 0).then(|| {
            format!(
                "in {count} of {samples} samples the controller wanted an input below its lower bound: a muscle can not push"
            )
        })
    }

    /// A warning of inputs at their upper bounds.
    pub fn at_upper_bound(&self) -> Option<String> {
        let (count, samples) = (self.samples_at_upper_bound, self.samples);
        (count > 0).then(|| {
            format!("in {count} of {samples} samples the controller wanted an input above its upper bound")
        })
    }
}

/// Length in mm of the path of a marker in the motion of the law.
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
