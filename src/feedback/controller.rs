//! The controller: inputs of a law from states that are measured at samples, delayed, and kept within bounds.
//!
//! A correction `−K (x − x₀)` is computed at each sample and acts, after the delay, until the next one does. Inputs of the motion are
//! known beforehand and act at once. An observer finds the state where it is not measured. A step allocates nothing.

use crate::feedback::law::Law;

/// State of a controller.
#[derive(Clone, Debug)]
pub struct Controller<'l> {
    law: &'l Law,
    /// Delay in ms between a sample and its effect.
    delay: f64,
    /// Deviations of the last sample: measured quantities, then integrals, then the corrections that will act before the next one does.
    deviation: Vec<f64>,
    /// Deviations of the measured quantities that the observer expects at the next sample; its errors of readings, and deviations of inputs.
    expected: Vec<f64>,
    errors: Vec<f64>,
    acting: Vec<f64>,
    /// Time in ms of the last sample.
    sampled: Option<f64>,
    /// Corrections that wait: the times in ms from which they act, and values by input.
    waiting: Vec<(f64, Vec<f64>)>,
    /// The oldest of them, and their number.
    first: usize,
    count: usize,
    /// The correction that acts.
    correction: Vec<f64>,
    samples: usize,
    /// Samples whose time had an input at its lower, and at its upper bound.
    saturated: [usize; 2],
    is_saturated: [bool; 2],
}

impl<'l> Controller<'l> {
    /// A controller with samples at this distance or more, and a delay, in ms.
    pub fn new(law: &'l Law, sample: f64, delay: f64) -> Self {
        let width = law.width();
        let waiting = (delay / sample).ceil() as usize + 2;
        let observed = law.observer.as_ref().map_or(0, |one| one.readings.len());
        Self {
            law,
            delay,
            deviation: vec![
                0.0;
                law.measured.len() + law.integral.of.len() + law.delay * law.width()
            ],
            expected: vec![0.0; law.measured.len()],
            errors: vec![0.0; observed],
            acting: vec![0.0; width],
            sampled: None,
            waiting: vec![(0.0, vec![0.0; width]); waiting],
            first: 0,
            count: 0,
            correction: vec![0.0; width],
            samples: 0,
            saturated: [0; 2],
            is_saturated: [false; 2],
        }
    }

    /// Takes the measured quantities, or the readings of the observer, at a time in ms. One that is no number was not measured: its deviation is
    /// that of before, and that which the observer expects.
    pub fn sample(&mut self, time: f64, measured: &[f64]) {
        let law = self.law;
        let elapsed = self.sampled.map_or(0.0, |before| time - before);
        self.sampled = Some(time);
        let m = law.measured.len();
        // The deviation of the last sample lasted until now.
        for (place, &of) in law.integral.of.iter().enumerate() {
            self.deviation[m + place] += elapsed * self.deviation[of];
        }
        match &law.observer {
            None => {
                for (place, value) in measured.iter().enumerate() {
                    if value.is_finite() {
                        self.deviation[place] = value - law.reference(time, place);
                    }
                }
            }
            Some(observer) => {
                let state = &mut self.deviation[..m];
                state.copy_from_slice(&self.expected);
                let filter = observer.at(law.interval(time));
                filter.correct(measured, state, &mut self.errors);
            }
        }
        self.predict(time);
        let slots = self.waiting.len();
        let slot = (self.first + self.count) % slots;
        match self.count < slots {
            true => self.count += 1,
            false => self.first = (self.first + 1) % slots,
        }
        let (acts, correction) = &mut self.waiting[slot];
        *acts = time + self.delay;
        let gain = &law.at(time).gain;
        for (input, value) in correction.iter_mut().enumerate() {
            let terms = self.deviation.iter().enumerate();
            *value = -terms
                .map(|(place, d)| gain[(input, place)] * d)
                .sum::<f64>();
        }
        self.samples += 1;
        self.is_saturated = [false; 2];
        self.expect(time);
    }

    /// Finds the state that the observer expects an interval after a time in ms.
    fn expect(&mut self, time: f64) {
        let law = self.law;
        let Some(observer) = &law.observer else {
            return;
        };
        let middle = time + 0.5 * law.h;
        for i in 0..law.width() {
            self.acting[i] = self.deviation_of_input(middle, i);
        }
        let state = &self.deviation[..law.measured.len()];
        let filter = observer.at(law.interval(time));
        filter.predict(state, &self.acting, &mut self.expected);
    }

    /// Deviation of an input from the motion at a time in ms, of its square where it acts by it, as bounds leave it.
    fn deviation_of_input(&self, time: f64, i: usize) -> f64 {
        let mut acting = &self.correction;
        for place in 0..self.count {
            let (from, correction) = &self.waiting[(self.first + place) % self.waiting.len()];
            if *from <= time {
                acting = correction;
            }
        }
        let given = self.law.at(time).inputs[i];
        let (wanted, [least, most], given) = self.law.inputs[i].wanted(given, acting[i]);
        wanted.clamp(least, most) - given
    }

    /// Takes in the corrections that act in the intervals of the delay from a time in ms on, as bounds leave them.
    fn predict(&mut self, time: f64) {
        let law = self.law;
        let first = law.measured.len() + law.integral.of.len();
        for k in 0..law.delay {
            let middle = time + (k as f64 + 0.5) * law.h;
            for i in 0..law.width() {
                self.deviation[first + k * law.width() + i] = self.deviation_of_input(middle, i);
            }
        }
    }

    /// Writes the inputs that act at a time in ms, with the corrections that act from another one on, by input of the law.
    pub fn inputs(&mut self, from: f64, time: f64, out: &mut [f64]) {
        while self.count > 0 && self.waiting[self.first].0 <= from + 1e-9 * (1.0 + from.abs()) {
            self.correction.copy_from_slice(&self.waiting[self.first].1);
            self.first = (self.first + 1) % self.waiting.len();
            self.count -= 1;
        }
        let point = self.law.at(time);
        let mut is_beyond = [false; 2];
        for (i, input) in self.law.inputs.iter().enumerate() {
            let (wanted, [least, most], _) = input.wanted(point.inputs[i], self.correction[i]);
            let slack = 1e-9 * (most - least);
            is_beyond[0] |= wanted < least - slack;
            is_beyond[1] |= wanted > most + slack;
            let kept = wanted.clamp(least, most);
            out[i] = if input.is_squared { kept.sqrt() } else { kept };
        }
        for (side, is_beyond) in is_beyond.into_iter().enumerate() {
            if is_beyond && !self.is_saturated[side] {
                self.saturated[side] += 1;
                self.is_saturated[side] = true;
            }
        }
    }

    /// Number of samples so far.
    pub fn samples(&self) -> usize {
        self.samples
    }

    /// Numbers of samples whose time had an input at its lower, and at its upper bound, beyond which it was wanted.
    pub fn saturated(&self) -> [usize; 2] {
        self.saturated
    }
}
