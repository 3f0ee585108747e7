//! The state from which a plan begins: as it was measured or found by the observer, and predicted over the delay by the inputs that were sent.

use crate::feedback::{Estimate, Law};

/// The state where a plan begins.
#[derive(Debug)]
pub(super) struct Predicted<'h> {
    law: &'h Law,
    delay: usize,
    /// The estimate at the last sample, and the same carried over the delay; none where the state is measured and nothing is delayed.
    estimates: Option<[Estimate<'h>; 2]>,
    /// Interval of the last sample.
    sampled: Option<usize>,
    /// Inputs as deviations from the motion that were sent for an interval, in turns.
    sent: Vec<Vec<f64>>,
    values: Vec<f64>,
    /// Room for what the gains read.
    deviation: Vec<f64>,
    correction: Vec<f64>,
}

impl<'h> Predicted<'h> {
    pub(super) fn new(law: &'h Law, delay: usize) -> Self {
        let width = law.width();
        let estimate = Estimate::new(law);
        Self {
            law,
            delay,
            estimates: estimate.map(|one| [one.clone(), one]),
            sampled: None,
            sent: vec![vec![0.0; width]; delay + 1],
            values: law.at(0.0).state.clone(),
            deviation: vec![0.0; law.estimated()],
            correction: vec![0.0; width],
        }
    }

    /// The state: rad, mm, rad/ms, mm/ms.
    pub(super) fn values(&self) -> &[f64] {
        &self.values
    }

    /// Constant disturbances, and the changes of inputs against them.
    pub(super) fn lasting(&self) -> (&[f64], &[f64]) {
        match &self.estimates {
            Some([here, _]) => (&here.state()[self.law.measured.len()..], here.against()),
            None => (&[], &[]),
        }
    }

    /// Finds the state behind the delay of a sample; without a measurement, the estimate goes on as expected.
    ///
    /// # Errors
    /// Nothing was measured, or no number.
    pub(super) fn find(&mut self, sample: usize, measured: Option<&[f64]>) -> Result<(), Source> {
        let is_number = |value: &f64| value.is_finite();
        let Some([here, ahead]) = &mut self.estimates else {
            let measured = measured.ok_or(Source::Late)?;
            if !measured.iter().all(is_number) {
                return Err(Source::Unusable);
            }
            self.values.copy_from_slice(measured);
            return Ok(());
        };
        let sent = &self.sent;
        let inputs = |k: usize| &*sent[k % sent.len()];
        // Intervals that were left out had the inputs that were sent last.
        let last = self.sampled.unwrap_or(sample);
        let first = last.max(sample.saturating_sub(sent.len()));
        for k in first..sample {
            here.go_on(k, inputs(k));
        }
        self.sampled = Some(sample);
        let found = match measured {
            None => Err(Source::Late),
            Some(readings) if readings.iter().any(is_number) => Ok(readings),
            Some(_) => Err(Source::Unusable),
        };
        match found {
            Ok(readings) => here.correct(sample, readings),
            Err(_) => here.trust(),
        }
        ahead.copy(here);
        for k in sample..sample + self.delay {
            ahead.go_on(k, inputs(k));
        }
        let motion = &self.law.at(self.law.h * (sample + self.delay) as f64).state;
        let all = motion.iter().zip(ahead.state());
        let values = self.values.iter_mut().zip(all);
        values.for_each(|(to, (motion, deviation))| *to = motion + deviation);
        found.map(|_| ())
    }

    /// Takes the last readings back.
    pub(super) fn distrust(&mut self) {
        if let Some([here, _]) = &mut self.estimates {
            here.trust();
        }
    }

    /// Notes the inputs that act in an interval.
    pub(super) fn sent(&mut self, interval: usize, inputs: &[f64]) {
        let given = &self.law.at(self.law.h * interval as f64).inputs;
        let slots = self.sent.len();
        let deviations = &mut self.sent[interval % slots];
        for (i, deviation) in deviations.iter_mut().enumerate() {
            let of = &self.law.inputs[i];
            *deviation = of.acting(inputs[i]) - of.acting(given[i]);
        }
    }

    /// The inputs of an interval by the gains of the law, within bounds.
    pub(super) fn regulate(&mut self, interval: usize, inputs: &mut [f64]) {
        let time = self.law.h * interval as f64;
        let point = self.law.at(time);
        let size = self.values.len();
        let both = self.values.iter().zip(&point.state);
        for (to, (x, motion)) in self.deviation.iter_mut().zip(both) {
            *to = x - motion;
        }
        if let Some([here, _]) = &self.estimates {
            let lasting = here.state()[size..].iter().chain(here.against());
            let of = self.deviation[size..].iter_mut().zip(lasting);
            of.for_each(|(to, value)| *to = *value);
        }
        self.law
            .correct(time, &self.deviation, &mut self.correction);
        let all = inputs.iter_mut().zip(&self.law.inputs);
        for (i, (to, input)) in all.enumerate() {
            *to = input.corrected(point.inputs[i], self.correction[i]);
        }
    }
}

/// Origin of the inputs of a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Source {
    /// The plan, with what was measured.
    Plan,
    /// The plan as it was: nothing was measured in time.
    Late,
    /// The plan as it was: what was measured is no state of the system.
    Unusable,
    /// The plan as it was: its iteration failed.
    Kept,
    /// The law of the regulator: the plan has failed, and begins anew.
    Regulator,
}

impl Source {
    /// All of them.
    pub const ALL: [Self; 5] = [
        Self::Plan,
        Self::Late,
        Self::Unusable,
        Self::Kept,
        Self::Regulator,
    ];

    /// Its name in a word.
    pub fn word(self) -> &'static str {
        match self {
            Self::Plan => "plan",
            Self::Late => "late",
            Self::Unusable => "unusable",
            Self::Kept => "kept",
            Self::Regulator => "regulator",
        }
    }
}
