//! A simulation under a controller: it measures the state at samples, and gives the inputs of its law.

use crate::control::problem::{FeedbackControl, Noise, Simulation, Voltages};
use crate::dynamics::trajectory::Trajectory;
use crate::dynamics::{DiscreteTrajectory, Drive, rates_of_momentum};
use crate::feedback::{Controller, Law, LawInput, Measured};
use crate::math::Random;
use crate::model::{Coordinates, Model, Role};
use crate::workflow::error::WorkflowError;
use crate::workflow::tracking::Tracked;
use serde::Serialize;
use std::cell::RefCell;
use std::collections::BTreeMap;

/// A controller at work on a model.
pub(crate) struct Loop<'a> {
    model: &'a Model,
    task: &'a FeedbackControl,
    voltages: &'a Voltages,
    /// Coordinate of each measured quantity; `None` for what this system does not remember.
    measured: Vec<Option<usize>>,
    /// Scalar of each input; `None` for one that does nothing here.
    scalars: Vec<Option<usize>>,
    state: RefCell<State<'a>>,
}

struct State<'a> {
    controller: Controller<'a>,
    random: Random,
    values: Vec<f64>,
    inputs: Vec<f64>,
    next: f64,
}

impl<'a> Loop<'a> {
    /// The loop of a task with a controller; without one there is none.
    ///
    /// # Errors
    /// The law is one of another robot.
    pub(crate) fn new(
        model: &'a Model,
        task: &'a Simulation,
    ) -> Result<Option<Self>, WorkflowError> {
        let Some(controller) = &task.controller else {
            return Ok(None);
        };
        let wrong = |reason: String| WorkflowError::Problem {
            place: "simulate.controller.feedback".to_owned(),
            reason: format!("{}: {reason}", controller.path.display()),
        };
        if model.coordinates == Coordinates::Redundant {
            let reason = "it measures joint coordinates; expected \"coordinates\": \"reduced\"";
            return Err(wrong(reason.to_owned()));
        }
        let law = &*controller.law;
        let end = law.duration() * (1.0 + 1e-9);
        if law.held.is_none() && task.duration > end {
            let reason = "it does not hold its goal after its end, where this simulation goes on; expected a shorter \"duration\"";
            return Err(wrong(reason.to_owned()));
        }
        let coordinates = model.variables.with(Role::Coordinate);
        let place = |one: &Measured| {
            let own = coordinates
                .iter()
                .position(|variable| variable.name == one.name);
            let own = own.filter(|&i| model.is_length(i) == one.is_length);
            match own {
                None if !one.is_memory => Err(wrong(format!(
                    "it measures {:?}, which this robot does not have; expected the feedback of a robot with the same joints",
                    one.name
                ))),
                own => Ok(own),
            }
        };
        let measured: Vec<Option<usize>> =
            law.measured.iter().map(place).collect::<Result<_, _>>()?;
        let sources = &model.sources;
        let scalar = |input: &LawInput| {
            let source = sources.iter().position(|source| source.name == input.name);
            source.and_then(|source| model.variables.input(source))
        };
        let inputs = law.inputs.len();
        Ok(Some(Self {
            model,
            task: controller,
            voltages: &task.voltages,
            scalars: law.inputs.iter().map(scalar).collect(),
            state: RefCell::new(State {
                controller: Controller::new(law, controller.sample, controller.delay),
                random: Random::new(controller.noise.seed),
                values: vec![0.0; measured.len()],
                inputs: vec![0.0; inputs],
                next: 0.0,
            }),
            measured,
        }))
    }

    /// Measures the last instant of a motion, if it is time.
    pub(crate) fn observe(&self, discrete: &DiscreteTrajectory) {
        let last = discrete.intervals();
        let time = discrete.times[last];
        let state = &mut *self.state.borrow_mut();
        if time < state.next - 1e-9 * (1.0 + time) {
            return;
        }
        // The first multiple of the sample behind this time.
        let sample = self.task.sample;
        state.next = sample * ((time / sample + 1e-6).floor() + 1.0);
        let rates = rates_of_momentum(
            self.model,
            &discrete.z[last],
            discrete.begun + time,
            &discrete.momenta[last],
        );
        let law = &*self.task.law;
        for (place, (of, coordinate)) in law.measured.iter().zip(&self.measured).enumerate() {
            state.values[place] = match (coordinate, of.is_rate) {
                (Some(i), false) => discrete.z[last][*i],
                (Some(i), true) => rates[*i],
                (None, _) => law.reference(time, place),
            };
            let noise = self.task.noise.of(of);
            if noise > 0.0 {
                state.values[place] += noise * state.random.normal();
            }
        }
        state.controller.sample(time, &state.values);
    }

    /// Numbers of samples, and of those with an input at its lower and upper bound.
    pub(crate) fn counts(&self) -> [usize; 3] {
        let controller = &self.state.borrow().controller;
        let [lower, upper] = controller.saturated();
        [controller.samples(), lower, upper]
    }
}

impl Drive for Loop<'_> {
    fn at(&self, [from, to]: [f64; 2], part: f64) -> Vec<f64> {
        let time = from + part * (to - from);
        let mut out = self.model.scalars(&self.voltages.at(time));
        let State {
            controller, inputs, ..
        } = &mut *self.state.borrow_mut();
        controller.inputs(from, time, inputs);
        for (scalar, value) in self.scalars.iter().zip(inputs) {
            if let Some(scalar) = scalar {
                out[*scalar] = *value;
            }
        }
        out
    }
}

impl Noise {
    /// The standard deviation of a measured quantity; what is remembered has none.
    fn of(&self, measured: &Measured) -> f64 {
        match (measured.is_length, measured.is_rate) {
            _ if measured.is_memory => 0.0,
            (false, false) => self.angle,
            (false, true) => self.angular_velocity,
            (true, false) => self.length,
            (true, true) => self.velocity,
        }
    }
}

/// The motion under a controller, and without its corrections, compared with that of the law.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ClosedLoop {
    /// Number of samples.
    pub samples: usize,
    /// Number of samples with an input at its lower bound, below which it was wanted: a muscle can not push.
    pub samples_at_lower_bound: usize,
    /// Number of samples with an input at its upper bound, above which it was wanted.
    pub samples_at_upper_bound: usize,
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
        law: &Law,
        [samples, samples_at_lower_bound, samples_at_upper_bound]: [usize; 3],
        discrete: &DiscreteTrajectory,
        open_loop: (DiscreteTrajectory, Option<String>),
    ) -> Self {
        let (open_loop, open_loop_failure) = open_loop;
        let [motion, open] = [discrete, &open_loop].map(|of| Trajectory::from_discrete(model, of));
        let mut out = Self {
            samples,
            samples_at_lower_bound,
            samples_at_upper_bound,
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
                None => String::new(),
            };
            format!("{name}: {}{open}", millimetres(&of.feedback))
        };
        self.markers.iter().map(line).collect()
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
