//! The controller: inputs of a law from states that are measured at samples, delayed, and kept within bounds.
//!
//! A correction `−K (x − x₀)` is computed at each sample and acts, after the delay, until the next one does. Inputs of the motion are
//! known beforehand and act at once. A step allocates nothing.

use crate::feedback::law::Law;

/// State of a controller.
#[derive(Clone, Debug)]
pub struct Controller<'l> {
    law: &'l Law,
    /// Delay in ms between a sample and its effect.
    delay: f64,
    /// Deviations of the last sample: measured quantities, then integrals.
    deviation: Vec<f64>,
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
    saturated: usize,
    is_saturated: bool,
}

impl<'l> Controller<'l> {
    /// A controller with samples at this distance or more, and a delay, in ms.
    pub fn new(law: &'l Law, sample: f64, delay: f64) -> Self {
        let inputs = law.inputs.len();
        let waiting = (delay / sample).ceil() as usize + 2;
        Self {
            law,
            delay,
            deviation: vec![0.0; law.measured.len() + law.integral.of.len()],
            sampled: None,
            waiting: vec![(0.0, vec![0.0; inputs]); waiting],
            first: 0,
            count: 0,
            correction: vec![0.0; inputs],
            samples: 0,
            saturated: 0,
            is_saturated: false,
        }
    }

    /// Takes the measured quantities at a time in ms.
    pub fn sample(&mut self, time: f64, measured: &[f64]) {
        let law = self.law;
        let elapsed = self.sampled.map_or(0.0, |before| time - before);
        self.sampled = Some(time);
        let m = measured.len();
        // The deviation of the last sample lasted until now.
        for (place, &of) in law.integral.of.iter().enumerate() {
            self.deviation[m + place] += elapsed * self.deviation[of];
        }
        for (place, value) in measured.iter().enumerate() {
            self.deviation[place] = value - law.reference(time, place);
        }
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
        self.is_saturated = false;
    }

    /// Writes the inputs that act from a time in ms on, by input of the law.
    pub fn inputs(&mut self, time: f64, out: &mut [f64]) {
        while self.count > 0 && self.waiting[self.first].0 <= time + 1e-9 * (1.0 + time.abs()) {
            self.correction.copy_from_slice(&self.waiting[self.first].1);
            self.first = (self.first + 1) % self.waiting.len();
            self.count -= 1;
        }
        let point = self.law.at(time);
        let mut is_beyond = false;
        for (i, input) in self.law.inputs.iter().enumerate() {
            let [low, high] = input.bounds;
            let given = point.inputs[i];
            let wanted = match input.is_squared {
                true => (given * given + self.correction[i]).max(0.0).sqrt(),
                false => given + self.correction[i],
            };
            let square = given * given + self.correction[i];
            let below_zero = input.is_squared && square < -1e-9 * high * high;
            out[i] = wanted.clamp(low, high);
            let slack = 1e-9 * (high - low).abs();
            is_beyond |= below_zero || wanted < low - slack || wanted > high + slack;
        }
        if is_beyond && !self.is_saturated {
            self.saturated += 1;
            self.is_saturated = true;
        }
    }

    /// Number of samples so far.
    pub fn samples(&self) -> usize {
        self.samples
    }

    /// Number of samples whose time had an input at a bound, beyond which it was wanted.
    pub fn saturated(&self) -> usize {
        self.saturated
    }
}
