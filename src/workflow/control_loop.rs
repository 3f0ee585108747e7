//! A controller at work in a simulation: it measures the state at samples, and gives the inputs of its law or plan.

use crate::control::problem::{FeedbackControl, Noise, Simulation, Voltages};
use crate::dynamics::{DiscreteTrajectory, Drive, rates_of_momentum};
use crate::feedback::{Controller, DelayLine, Law, LawInput, Measured, Reading};
use crate::math::Random;
use crate::model::{Coordinates, Model, Role};
use crate::workflow::error::WorkflowError;
use crate::workflow::receding::{Horizon, RecedingHorizon};
use crate::workflow::regulator::remembered;
use serde::Serialize;
use std::cell::RefCell;
use std::collections::BTreeMap;
use std::sync::Arc;
use std::time::Instant;

/// A controller at work on a model.
pub(crate) struct Loop<'a> {
    model: &'a Model,
    task: &'a FeedbackControl,
    law: &'a Law,
    voltages: &'a Voltages,
    /// Coordinate of each measured quantity; `None` for what this system does not remember.
    measured: Vec<Option<usize>>,
    /// Vector of each reading of an observer that is of a marker; empty without one.
    markers: Vec<Option<usize>>,
    /// Scalar of each input; `None` for one that does nothing here.
    scalars: Vec<Option<usize>>,
    state: RefCell<State<'a>>,
}

struct State<'a> {
    controller: Box<dyn Acting + 'a>,
    random: Random,
    values: Vec<f64>,
    inputs: Vec<f64>,
    next: f64,
}

/// A controller at work: that of a law, or one that plans anew.
trait Acting {
    /// Takes what was measured at a time in ms.
    fn sample(&mut self, time: f64, measured: &[f64]);

    /// Writes the inputs at a time in ms, with what acts from another one on.
    fn inputs(&mut self, from: f64, time: f64, out: &mut [f64]);

    /// Samples, with an input at its lower and at its upper bound, and its plans.
    fn counts(&self) -> ([usize; 3], Option<Plans>);
}

impl Acting for Controller<'_> {
    fn sample(&mut self, time: f64, measured: &[f64]) {
        Controller::sample(self, time, measured);
    }

    fn inputs(&mut self, from: f64, time: f64, out: &mut [f64]) {
        Controller::inputs(self, from, time, out);
    }

    fn counts(&self) -> ([usize; 3], Option<Plans>) {
        (self.samples(), None)
    }
}

/// A controller that plans anew.
struct Planning<'a> {
    controller: RecedingHorizon<'a>,
    law: &'a Law,
    delay: f64,
    sent: DelayLine,
    samples: [usize; 3],
    plans: Plans,
}

impl Acting for Planning<'_> {
    /// The next step is prepared after the answer.
    fn sample(&mut self, time: f64, measured: &[f64]) {
        let began = Instant::now();
        let answer = self.controller.step(time, Some(measured));
        let sent = self.sent.push(time + self.delay);
        sent.copy_from_slice(answer.inputs);
        *self.plans.sources.entry(answer.source.word()).or_default() += 1;
        let answered = began.elapsed().as_secs_f64();
        let is_at = |side: usize| {
            let mut each = self.law.inputs.iter().zip(answer.inputs);
            each.any(|(input, value)| input.is_at_bound(*value, side))
        };
        let counts = self.samples.iter_mut().zip([true, is_at(0), is_at(1)]);
        counts.for_each(|(count, is_one)| *count += usize::from(is_one));
        self.controller.prepare();
        let whole = &mut self.plans.longest_with_preparation;
        *whole = whole.max(began.elapsed().as_secs_f64());
        self.plans.longest_step = self.plans.longest_step.max(answered);
    }

    /// Before the first that were sent, the inputs of the motion act.
    fn inputs(&mut self, from: f64, _: f64, out: &mut [f64]) {
        let (since, sent) = self.sent.at(self.law.now(from));
        out.copy_from_slice(match since.is_finite() {
            true => sent,
            false => &self.law.at(from).inputs,
        });
    }

    fn counts(&self) -> ([usize; 3], Option<Plans>) {
        (self.samples, Some(self.plans.clone()))
    }
}

/// Counts of a loop.
#[derive(Clone, Debug)]
pub(crate) struct Counts {
    /// Samples, and those of them with an input at its lower and at its upper bound.
    pub(crate) samples: [usize; 3],
    pub(crate) plans: Option<Plans>,
    /// The law that was followed.
    pub(crate) law: Arc<Law>,
}

/// Steps of a controller that plans anew.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Plans {
    /// Numbers of steps by the origin of their inputs.
    pub sources: BTreeMap<&'static str, usize>,
    /// The longest time in s from a measurement to its inputs.
    pub longest_step: f64,
    /// The same with the preparation of the next step.
    pub longest_with_preparation: f64,
}

/// A horizon of a task whose controller plans anew.
///
/// # Errors
/// There is none.
pub(crate) fn horizon(task: &Simulation) -> Result<Option<Horizon>, WorkflowError> {
    let controller = task.controller.as_ref();
    let Some((path, ahead)) = controller.and_then(|one| Some((&one.path, one.ahead.as_ref()?)))
    else {
        return Ok(None);
    };
    let words = format!("{}: ", path.display());
    let found = Horizon::solved(ahead).map(Some);
    found.map_err(|error| error.at("simulate.controller.horizon", &words))
}

impl<'a> Loop<'a> {
    /// The loop of a task with a controller; without one there is none.
    ///
    /// # Errors
    /// The law is one of another robot.
    pub(crate) fn new(
        model: &'a Model,
        task: &'a Simulation,
        horizon: Option<&'a Horizon>,
    ) -> Result<Option<Self>, WorkflowError> {
        let Some(controller) = &task.controller else {
            return Ok(None);
        };
        let kind = horizon.map_or("feedback", |_| "horizon");
        let wrong = |reason: &str| {
            let place = format!("simulate.controller.{kind}");
            WorkflowError::problem(place, format!("{}: {reason}", controller.path.display()))
        };
        if model.coordinates == Coordinates::Redundant {
            let reason = "it measures joint coordinates; expected \"coordinates\": \"reduced\"";
            return Err(wrong(reason));
        }
        let law = horizon.map_or(&*controller.law, Horizon::law);
        if let Some(key) = controller.noise.unread(law) {
            let [found, expected] = Noise::UNREAD;
            let place = format!("simulate.controller.noise.{key}");
            let reason = format!("found {found}, expected {expected}");
            return Err(WorkflowError::problem(place, reason));
        }
        let end = law.duration() * (1.0 + 1e-9);
        if !law.holds_goal() && task.duration > end {
            let reason = "it does not hold its goal after its end, where this simulation goes on; expected a shorter \"duration\"";
            return Err(wrong(reason));
        }
        let measured = measured(model, law).map_err(|reason| wrong(&reason))?;
        let markers = markers(model, law).map_err(|reason| wrong(&reason))?;
        let sources = &model.sources;
        let scalar = |input: &LawInput| {
            let source = sources.iter().position(|source| source.name == input.name);
            source.and_then(|source| model.variables.input(source))
        };
        let FeedbackControl { sample, delay, .. } = **controller;
        let acting: Box<dyn Acting + 'a> = match horizon {
            Some(horizon) => Box::new(Planning {
                controller: RecedingHorizon::new(horizon),
                law,
                delay,
                sent: DelayLine::new(law.width(), sample, delay),
                samples: [0; 3],
                plans: Plans::default(),
            }),
            None => Box::new(Controller::new(law, sample, delay)),
        };
        Ok(Some(Self {
            model,
            task: controller,
            law,
            voltages: &task.voltages,
            scalars: law.inputs.iter().map(scalar).collect(),
            state: RefCell::new(State {
                controller: acting,
                random: Random::new(controller.noise.seed),
                values: vec![0.0; law.readings()],
                inputs: vec![0.0; law.width()],
                next: 0.0,
            }),
            measured,
            markers,
        }))
    }

    /// Measures the last instant of a motion, if it is time.
    pub(crate) fn observe(&self, discrete: &DiscreteTrajectory) {
        let last = discrete.intervals();
        let time = discrete.times[last];
        let state = &mut *self.state.borrow_mut();
        let sample = self.task.sample;
        if time < state.next - 1e-9 * (sample + time) {
            return;
        }
        // The first multiple of the sample behind this time.
        state.next = sample * ((time / sample + 1e-6).floor() + 1.0);
        let (law, z, momentum) = (self.law, &discrete.z[last], &discrete.momenta[last]);
        let rates = rates_of_momentum(self.model, z, discrete.begun + time, momentum);
        let of_state = |place: usize| {
            let of = &law.measured[place];
            let value = match (self.measured[place], of.is_rate) {
                (Some(i), false) => match (of.memory, remembered(self.model, i)) {
                    (Some(own), Some(here)) => own.take(z[i], here),
                    _ => z[i],
                },
                (Some(i), true) => rates[i],
                (None, _) => law.reference(time, place),
            };
            (value, self.task.noise.of(of))
        };
        let first = self.markers.first();
        let instant = first.map(|_| self.model.action.map.placed(z));
        for place in 0..state.values.len() {
            let reading = law.observer.as_ref().map(|one| &one.readings[place]);
            let (value, noise) = match reading {
                None => of_state(place),
                Some(&Reading::State(place)) => of_state(place),
                Some(&Reading::Marker(_, axis)) => {
                    let vector = self.markers[place].expect("a reading of a marker");
                    let instant = instant.as_ref().expect("a placed instant");
                    (instant.x[vector][axis], self.task.noise.length)
                }
            };
            let has_noise = noise > 0.0;
            let random = has_noise.then(|| state.random.normal());
            state.values[place] = value + noise * random.unwrap_or(0.0);
        }
        state.controller.sample(time, &state.values);
    }

    /// Counts of its samples.
    pub(crate) fn counts(&self) -> Counts {
        let (samples, plans) = self.state.borrow().controller.counts();
        let law = Arc::new(self.law.clone());
        Counts {
            samples,
            plans,
            law,
        }
    }
}

/// Coordinate of each measured quantity of a law; `None` for what this system does not remember.
fn measured(model: &Model, law: &Law) -> Result<Vec<Option<usize>>, String> {
    let coordinates = model.variables.with(Role::Coordinate);
    let place = |one: &Measured| {
        let own = coordinates.iter().position(|it| it.name == one.name);
        let own = own.filter(|&i| model.is_length(i) == one.is_length);
        match own {
            None if one.memory.is_none() => Err(format!(
                "it measures {:?}, which this robot does not have; expected the feedback of a robot with the same joints",
                one.name
            )),
            own => Ok(own),
        }
    };
    law.measured.iter().map(place).collect()
}

/// Vector of each reading of an observer that is of a marker; none without an observer.
fn markers(model: &Model, law: &Law) -> Result<Vec<Option<usize>>, String> {
    let readings = law.observer.iter().flat_map(|one| &one.readings);
    let marker = |reading: &Reading| match reading {
        Reading::State(_) => Ok(None),
        Reading::Marker(name, _) => {
            let mut markers = model.system.markers.iter();
            let own = markers.position(|marker| marker.name == *name);
            let own = own.ok_or_else(|| {
                format!("its observer reads marker {name:?}, which this robot does not have")
            })?;
            Ok(Some(model.markers[own]))
        }
    };
    readings.map(marker).collect()
}

/// The inputs in the middle of a step act in all of it.
impl Drive for Loop<'_> {
    fn at(&self, [from, to]: [f64; 2], _: f64) -> Vec<f64> {
        let time = from + 0.5 * (to - from);
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
            _ if measured.memory.is_some() => 0.0,
            (false, false) => self.angle,
            (false, true) => self.angular_velocity,
            (true, false) => self.length,
            (true, true) => self.velocity,
        }
    }
}
