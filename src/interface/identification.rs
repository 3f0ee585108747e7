//! Identification: constants fitted to recordings.

use crate::control::problem::{
    self, ChangedScene, Channel, Prior, Reading, Regime, SoughtStart, begin_late,
};
use crate::identify::{Identified, identify};
use crate::interface::error::{Entry, Result, signals};
use crate::interface::handle::{Handle, Input, builder};
use crate::interface::state::State;
use crate::math::{Signal, Vector, in_order, refuse};
use crate::model::components::{Load, Spring, Tendon};
use crate::model::system::{Joint, Marker, Muscle};
use crate::model::{Parameter, Pulling, Quantity, System};

/// Constants that are fitted to recordings.
#[derive(Clone, Debug)]
pub struct Identification {
    parameters: Vec<Parameter>,
    priors: Vec<(String, [f64; 2])>,
    recordings: Vec<Recording>,
    step: Option<f64>,
}

/// Readings of a motion from the reference configuration at rest without voltages, or of another one, or of states of rest.
#[derive(Clone, Debug)]
pub struct Recording {
    name: String,
    scene: Option<System>,
    regime: Regime,
    start: State,
    sought_start: SoughtStart,
    is_held_out: bool,
    inputs: Vec<(Input, Signal)>,
    time_offset: Option<f64>,
    channels: Vec<Channel>,
}

/// The force in N with which a muscle, a spring or a tendon pulls its ends together.
#[derive(Clone, Debug)]
pub struct Tension(Quantity);

/// Declares kinds of parts that pull.
macro_rules! pulling {
    ($($part:ident)*) => {$(
        impl From<Handle<$part>> for Tension {
            fn from(part: Handle<$part>) -> Self {
                Self(Quantity::tension(Pulling::$part(part.index())))
            }
        }
    )*};
}
pulling!(Muscle Spring Tendon);

impl Recording {
    /// A recording without readings; the name is for messages.
    pub fn new(name: impl Into<String>) -> Self {
        Self {
            name: name.into(),
            scene: None,
            regime: Regime::Motion,
            start: State::Reference,
            sought_start: SoughtStart::Nothing,
            is_held_out: false,
            inputs: Vec::new(),
            time_offset: None,
            channels: Vec::new(),
        }
    }

    fn measure(
        &mut self,
        parts: Vec<(f64, Quantity)>,
        readings: impl IntoIterator<Item = (f64, f64)>,
        deviation: Option<f64>,
    ) {
        let reading = |(time, value)| Reading {
            time,
            value,
            deviation: deviation.unwrap_or(1.0),
        };
        self.channels.push(Channel {
            name: format!("quantity {}", self.channels.len() + 1),
            parts,
            unit: ("", 1.0),
            is_deviation_known: deviation.is_some(),
            readings: readings.into_iter().map(reading).collect(),
        });
    }

    fn resolve(&self, system: &System, parameters: &[Parameter]) -> Result<problem::Recording> {
        let scene = self.scene.as_ref().map(System::checked).transpose()?;
        let system = scene.as_ref().unwrap_or(system);
        let signals = signals(&self.inputs, "recording", system)?;
        let mut channels = self.channels.clone();
        let begin = self.time_offset.unwrap_or(0.0);
        let all = channels.iter_mut().flat_map(|one| &mut one.readings);
        all.for_each(|reading| reading.time -= begin);
        let times = channels.iter().flat_map(|one| &one.readings);
        let times = in_order(times.map(|reading| reading.time));
        let is_open = self.time_offset.is_none() && self.regime == Regime::Motion;
        let is_late = is_open && begin_late(&times);
        refuse!(if is_late, Entry("recording");
            found format!("{} ms at the first reading", times[0]),
            expected "a \"time_offset\": that time if the motion begins then, or 0");
        let all = channels.iter().flat_map(|one| &one.readings);
        for reading in all {
            let numbers = [reading.time, reading.value];
            let holds = numbers.iter().all(|x| x.is_finite()) && reading.time >= 0.0;
            refuse!(unless holds && reading.deviation > 0.0, Entry("recording");
                found format!("{} at {} ms", reading.value, reading.time),
                expected "finite readings at times from 0 on");
        }
        Ok(problem::Recording {
            name: self.name.clone(),
            start: self.start.resolve(system)?,
            regime: self.regime,
            sought_start: self.sought_start,
            is_held_out: self.is_held_out,
            voltages: signals.into(),
            channels,
            scene: scene.map(|system| {
                Box::new(ChangedScene {
                    system,
                    parameters: parameters.to_vec(),
                })
            }),
        })
    }
}

builder! {
    impl Recording;
    /// Readings of a coordinate of a joint in rad or mm at times in ms, with their standard deviation; `None`: the residuals tell it.
    joint(joint: Handle<Joint>, readings: impl IntoIterator<Item = (f64, f64)>, deviation: impl Into<Option<f64>>) |of| {
        of.measure(vec![(1.0, Quantity::joint(joint.index(), 0.0))], readings, deviation.into());
    };
    /// Readings of the place of a marker along a direction in mm at times in ms, with their standard deviation.
    marker(marker: Handle<Marker>, along: Vector, readings: impl IntoIterator<Item = (f64, f64)>, deviation: impl Into<Option<f64>>) |of| {
        let along = along.normalize();
        let part = |axis: usize| (along[axis], Quantity::marker_place(marker.index(), axis));
        of.measure((0..3).map(part).collect(), readings, deviation.into());
    };
    /// Readings of the force in N with which a muscle, a spring or a tendon pulls its ends together.
    tension(part: impl Into<Tension>, readings: impl IntoIterator<Item = (f64, f64)>, deviation: impl Into<Option<f64>>) |of| {
        of.measure(vec![(1.0, part.into().0)], readings, deviation.into());
    };
    /// Readings of a linear combination of quantities of the model, in its units.
    measured(parts: Vec<(f64, Quantity)>, readings: impl IntoIterator<Item = (f64, f64)>, deviation: impl Into<Option<f64>>) |of| {
        of.measure(parts, readings, deviation.into());
    };
    /// The size of a load in N, or N mm of a torque: a constant or a [`Signal`].
    load(load: Handle<Load>, size: impl Into<Signal>) |of| of.inputs.push((load.into(), size.into()));
    /// Time in ms of the readings at which the motion begins, 0 where it is not said; readings that begin late need it.
    time_offset(time: f64) |of| of.time_offset = Some(time);
    /// Another system than that of the identification, with the same parts and more, such as a payload.
    of(system: System) |of| of.scene = Some(system);
    /// Another start.
    start(start: State) |of| of.start = start;
    /// The part of the start that is unknown, and fitted too.
    sought_start(sought_start: SoughtStart) |of| of.sought_start = sought_start;
    /// Each reading is one of the state of rest under the voltages of its time.
    at_rest() |of| of.regime = Regime::Rest;
    /// No constant is fitted to it: it checks the prediction.
    held_out() |of| of.is_held_out = true;
    /// The voltage of a muscle or electrode: a constant in V or a [`Signal`].
    voltage(input: impl Into<Input>, signal: impl Into<Signal>) |of| of.inputs.push((input.into(), signal.into()));
}

impl Identification {
    /// Of free parameters within their bounds; they have names, bounds and guesses as in a [`Control`](crate::Control).
    pub fn of(parameters: impl IntoIterator<Item = Parameter>) -> Self {
        Self {
            parameters: parameters.into_iter().collect(),
            priors: Vec::new(),
            recordings: Vec::new(),
            step: None,
        }
    }

    /// Fits the constants, and says how well the recordings determine them.
    ///
    /// ```
    /// use proboscis::prelude::*;
    ///
    /// # fn main() -> Result<()> {
    /// let mut system = System::new("oscillator");
    /// let cart = system.add(Body::sphere(mm(10.0)).mass(g(50.0)));
    /// let slide = system.add(Joint::prismatic(X).between(GROUND, cart));
    /// let spring = Spring::between((GROUND, -X * mm(50.0)), (cart, X * mm(0.0)));
    /// let spring = system.add(spring.stiffness(n_per_m(120.0)));
    /// // Places in mm at times in ms of a twin of 200 N/m.
    /// let place = |t: f64| 5.0 * (t * (0.2_f64 / 50.0).sqrt()).cos();
    /// let readings = (0..30).map(|k| 5.0 * f64::from(k)).map(|t| (t, place(t)));
    /// let recording = Recording::new("released")
    ///     .start(State::Joints(vec![(slide, mm(5.0))]))
    ///     .joint(slide, readings, mm(0.01));
    /// let stiffness = Parameter::new("stiffness", 0.05..=0.9, 0.12).is(spring.stiffness());
    /// let found = Identification::of([stiffness]).recording(recording).run(&system)?;
    /// assert!((found.fit.of_constants()[0] - 0.2).abs() < 1e-5);
    /// assert!(found.information.half(0) < 1e-3 && found.information.undetermined.is_empty());
    /// # Ok(())
    /// # }
    /// ```
    ///
    /// # Errors
    /// System, recordings or constants make no sense, or a motion cannot be simulated.
    pub fn run(&self, system: &System) -> Result<Identified> {
        let system = &system.checked()?;
        for parameter in &self.parameters {
            let [lower, guess, upper] = [parameter.lower, parameter.guess, parameter.upper];
            let holds = lower < upper && (lower..=upper).contains(&guess) && guess.is_finite();
            refuse!(unless holds, Entry("identification");
                found format!("{:?}, {guess} in {lower}..={upper}", parameter.name),
                expected "a finite guess within bounds");
        }
        let resolved = |one: &Recording| one.resolve(system, &self.parameters);
        let recordings = self.recordings.iter().map(resolved);
        let recordings: Vec<_> = recordings.collect::<Result<_>>()?;
        refuse!(unless recordings.iter().any(|one| !one.is_held_out), Entry("identification");
            found format!("{} recordings", recordings.len()),
            expected "one or more to which constants are fitted");
        let step = self.step.is_none_or(|step| step > 0.0 && step.is_finite());
        refuse!(unless step, Entry("identification");
            found format!("{:?}", self.step), expected "a positive step");
        let prior = |(name, [value, deviation]): &(String, [f64; 2])| {
            let constant = self.parameters.iter().position(|one| one.name == *name);
            let holds = constant.is_some() && value.is_finite();
            refuse!(unless holds && *deviation > 0.0 && deviation.is_finite(), Entry("identification");
                found format!("the prior {value} ± {deviation} of {name:?}"),
                expected "a finite value and a positive deviation of a free parameter");
            Ok(Prior {
                constant: constant.unwrap_or_default(),
                value: *value,
                deviation: *deviation,
            })
        };
        let task = problem::Identification {
            parameters: self.parameters.clone(),
            priors: self.priors.iter().map(prior).collect::<Result<_>>()?,
            recordings,
            candidates: Vec::new(),
            step: self.step,
            coordinates: None,
        };
        Ok(identify(system, &task, &mut |_, _| {})?)
    }
}

builder! {
    impl Identification;
    /// A constant that is known beside the recordings: its mean and standard deviation, in its units; it counts as one reading more.
    prior(name: impl Into<String>, value: f64, deviation: f64) |of| of.priors.push((name.into(), [value, deviation]));
    /// A recording more.
    recording(recording: Recording) |of| of.recordings.push(recording);
    /// Step of the first grid in ms, which is halved until its bias is small; by the number of readings where there is none.
    step(step: f64) |of| of.step = Some(step);
}
