//! The controller: inputs of a law from states that are measured at samples, delayed, and kept within bounds.
//!
//! A correction `−K (x − x₀)` is computed at each sample and acts, after the delay, until the next one does. Inputs of the motion are
//! known beforehand and act at once. An observer finds the state where it is not measured. A step allocates nothing.

use crate::feedback::law::{Law, Observer};
use std::collections::VecDeque;

/// Values with the times in ms from which they act, the newest at the end. A step allocates nothing.
#[derive(Clone, Debug)]
pub struct DelayLine(VecDeque<(f64, Vec<f64>)>);

impl DelayLine {
    /// A line for samples at this distance or more, and a delay, in ms; before the first values zeros act.
    pub fn new(width: usize, sample: f64, delay: f64) -> Self {
        let slots = (delay / sample).ceil() as usize + 3;
        Self(vec![(f64::NEG_INFINITY, vec![0.0; width]); slots].into())
    }

    /// The place of the oldest values, for those that act from a time on.
    pub fn push(&mut self, from: f64) -> &mut [f64] {
        self.0.rotate_left(1);
        let (acts, values) = self.0.back_mut().expect("three values or more");
        *acts = from;
        values
    }

    /// The time from which those values act that do at a time, and the values.
    pub fn at(&self, time: f64) -> (f64, &[f64]) {
        let mut newest = self.0.iter().rev();
        let acting = newest.find(|(from, _)| *from <= time);
        let (from, values) = acting.unwrap_or(&self.0[0]);
        (*from, values)
    }
}

/// State of a controller.
#[derive(Clone, Debug)]
pub struct Controller<'l> {
    law: &'l Law,
    /// Delay in ms between a sample and its effect.
    delay: f64,
    /// Numbers of the last sample that the gains read: deviations of measured quantities, constant disturbances with the inputs against them, integrals, then the
    /// corrections that will act before the next one does.
    deviation: Vec<f64>,
    /// That of the observer, where there is one, and deviations of inputs.
    estimate: Option<Estimate<'l>>,
    acting: Vec<f64>,
    /// Time in ms of the last sample.
    sampled: Option<f64>,
    /// Corrections by input.
    corrections: DelayLine,
    samples: [usize; 3],
    is_saturated: [bool; 2],
}

impl<'l> Controller<'l> {
    /// A controller with samples at this distance or more, and a delay, in ms.
    pub fn new(law: &'l Law, sample: f64, delay: f64) -> Self {
        let width = law.width();
        let read = law.estimated() + law.integral.of.len();
        Self {
            law,
            delay,
            deviation: vec![0.0; read + law.delay * law.width()],
            estimate: Estimate::new(law),
            acting: vec![0.0; width],
            sampled: None,
            corrections: DelayLine::new(width, sample, delay),
            samples: [0; 3],
            is_saturated: [false; 2],
        }
    }

    /// Takes the measured quantities, or the readings of the observer, at a time in ms. One that is no number was not measured: its deviation is
    /// that of before, and that which the observer expects.
    pub fn sample(&mut self, time: f64, measured: &[f64]) {
        let law = self.law;
        let elapsed = self.sampled.map_or(0.0, |before| time - before);
        self.sampled = Some(time);
        // The deviation of the last sample lasted until now.
        let first = law.estimated();
        for (place, &of) in law.integral.of.iter().enumerate() {
            self.deviation[first + place] += elapsed * self.deviation[of];
        }
        match &mut self.estimate {
            None => {
                for (place, value) in measured.iter().enumerate() {
                    if value.is_finite() {
                        self.deviation[place] = value - law.reference(time, place);
                    }
                }
            }
            Some(estimate) => {
                estimate.correct(law.interval(time), measured);
                let found = estimate.state().iter().chain(estimate.against());
                let read = self.deviation.iter_mut().zip(found);
                read.for_each(|(to, value)| *to = *value);
            }
        }
        self.predict(time);
        let correction = self.corrections.push(time + self.delay);
        law.correct(time, &self.deviation, correction);
        self.samples[0] += 1;
        self.is_saturated = [false; 2];
        self.expect(time);
    }

    /// Finds the state that the observer expects an interval after a time in ms.
    fn expect(&mut self, time: f64) {
        let law = self.law;
        if self.estimate.is_none() {
            return;
        }
        let middle = time + 0.5 * law.h;
        for i in 0..law.width() {
            self.acting[i] = self.deviation_of_input(middle, i);
        }
        if let Some(estimate) = &mut self.estimate {
            estimate.expect(law.interval(time), &self.acting);
        }
    }

    /// Deviation of an input from the motion at a time in ms, of its square where it acts by it, as bounds leave it.
    fn deviation_of_input(&self, time: f64, i: usize) -> f64 {
        let (_, acting) = self.corrections.at(time);
        let given = self.law.at(time).inputs[i];
        let (wanted, [least, most], given) = self.law.inputs[i].wanted(given, acting[i]);
        wanted.clamp(least, most) - given
    }

    /// Takes in the corrections that act in the intervals of the delay from a time in ms on, as bounds leave them.
    fn predict(&mut self, time: f64) {
        let law = self.law;
        let first = law.estimated() + law.integral.of.len();
        for k in 0..law.delay {
            let middle = time + (k as f64 + 0.5) * law.h;
            for i in 0..law.width() {
                self.deviation[first + k * law.width() + i] = self.deviation_of_input(middle, i);
            }
        }
    }

    /// Writes the inputs that act at a time in ms, with the corrections that act from another one on, by input of the law.
    pub fn inputs(&mut self, from: f64, time: f64, out: &mut [f64]) {
        let law = self.law;
        let (_, correction) = self.corrections.at(law.now(from));
        let point = self.law.at(time);
        let mut is_beyond = [false; 2];
        for (i, input) in self.law.inputs.iter().enumerate() {
            let (wanted, [least, most], _) = input.wanted(point.inputs[i], correction[i]);
            let slack = 1e-9 * (most - least);
            is_beyond[0] |= wanted < least - slack;
            is_beyond[1] |= wanted > most + slack;
            out[i] = input.corrected(point.inputs[i], correction[i]);
        }
        for (side, is_beyond) in is_beyond.into_iter().enumerate() {
            if is_beyond && !self.is_saturated[side] {
                self.samples[1 + side] += 1;
                self.is_saturated[side] = true;
            }
        }
    }

    /// Numbers of samples so far, and of those whose time had an input at its lower, and at its upper bound, beyond which it was wanted.
    pub fn samples(&self) -> [usize; 3] {
        self.samples
    }
}

/// An estimate, as deviations from the motion.
#[derive(Clone, Debug)]
pub struct Estimate<'l> {
    law: &'l Law,
    observer: &'l Observer,
    /// The state, then the forces; those that are expected at the next sample.
    state: Vec<f64>,
    expected: Vec<f64>,
    /// Changes of the inputs that hold the goal against the forces, and their limits; none without forces.
    against: Vec<f64>,
    limits: Vec<[f64; 2]>,
    /// Room for errors of readings, and for what is left of forces.
    errors: Vec<f64>,
    left: Vec<f64>,
}

impl<'l> Estimate<'l> {
    /// That of the observer of a law, where there is one, on the motion.
    pub fn new(law: &'l Law) -> Option<Self> {
        let observer = law.observer.as_ref()?;
        let forces = law.forces();
        let size = law.measured.len() + forces;
        let goal = law.held.as_ref().or(law.points.last());
        let goal = &goal.expect("a law has an interval").inputs;
        let limits = law.inputs.iter().zip(goal).map(|(input, given)| {
            let (_, bounds, acting) = input.wanted(*given, 0.0);
            bounds.map(|bound| bound - acting)
        });
        Some(Self {
            limits: limits.take(law.targets()).collect(),
            law,
            observer,
            state: vec![0.0; size],
            expected: vec![0.0; size],
            against: vec![0.0; law.targets()],
            errors: vec![0.0; observer.readings.len()],
            left: vec![0.0; forces],
        })
    }

    /// Takes in the readings at the start of an interval; those that are no numbers were not measured.
    pub fn correct(&mut self, interval: usize, readings: &[f64]) {
        self.state.copy_from_slice(&self.expected);
        let filter = self.observer.at(interval);
        filter.correct(readings, &mut self.state, &mut self.errors);
        self.hold();
    }

    /// Takes what is expected for the state, as where nothing was measured.
    pub fn trust(&mut self) {
        self.state.copy_from_slice(&self.expected);
        self.hold();
    }

    fn hold(&mut self) {
        if let Some(lasting) = &self.observer.lasting {
            let forces = &self.state[self.law.measured.len()..];
            lasting.hold(forces, &self.limits, &mut self.against, &mut self.left);
        }
    }

    /// Expects the state an interval later, under deviations of the inputs of this interval.
    pub fn expect(&mut self, interval: usize, inputs: &[f64]) {
        let filter = self.observer.at(interval);
        filter.predict(&self.state, inputs, &mut self.expected);
        if interval + 1 == self.observer.points.len() {
            let jump = self.expected.iter_mut().zip(&self.observer.jump);
            jump.for_each(|(x, jump)| *x += jump);
        }
    }

    /// Goes on to the next interval without readings, under deviations of inputs.
    pub fn go_on(&mut self, interval: usize, inputs: &[f64]) {
        self.expect(interval, inputs);
        self.state.copy_from_slice(&self.expected);
    }

    /// Deviations of the state, then the constant disturbances.
    pub fn state(&self) -> &[f64] {
        &self.state
    }

    /// Changes of the inputs that hold the goal against the forces.
    pub fn against(&self) -> &[f64] {
        &self.against
    }

    /// Takes over another estimate of the same law.
    pub fn copy(&mut self, other: &Self) {
        self.state.copy_from_slice(&other.state);
        self.expected.copy_from_slice(&other.expected);
        self.against.copy_from_slice(&other.against);
    }
}
