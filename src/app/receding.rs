//! The controller of a receding horizon for other languages: from a problem file, in SI units.

use std::path::Path;

use crate::app::error::CommandError;
use crate::app::messages::key;
use crate::app::task::read;
use crate::control::problem::{Ahead, Task};
use crate::feedback::{Measured, Reading};
use crate::files::feedback::{factor_of, unit_of};
use crate::model::System;
use crate::workflow::receding::{Horizon, RecedingHorizon, Source};

/// A horizon of a problem file, with its system.
#[derive(Debug)]
pub struct FileHorizon {
    horizon: Horizon,
    system: System,
}

impl FileHorizon {
    /// Solves the control problem of a file, of its text where that is given, for a horizon of a number of its intervals. The costs of deviations are
    /// those of its `feedback`.
    ///
    /// # Errors
    /// The problem is wrong, asks for something else, or has no horizon.
    pub fn new(input: &Path, text: Option<&str>, intervals: usize) -> Result<Self, CommandError> {
        let loaded = read(input, text, &[])?;
        let wrong = |place: &str, reason: String| CommandError::Problem {
            file: input.to_owned(),
            place: place.to_owned(),
            reason,
        };
        let expected = match intervals {
            0 => Some("1 or more".to_owned()),
            _ if intervals > Ahead::MOST_INTERVALS => {
                Some(format!("no more than {} intervals", Ahead::MOST_INTERVALS))
            }
            _ => None,
        };
        if let Some(expected) = expected {
            let reason = format!("found a horizon of {intervals} intervals, expected {expected}");
            return Err(wrong("", reason));
        }
        let Task::Control(control) = loaded.task else {
            let reason = "only \"control\" is planned anew".to_owned();
            return Err(wrong(key(&loaded.task), reason));
        };
        let ahead = Ahead {
            system: loaded.system,
            control: *control,
            regulator: loaded.feedback.unwrap_or_default(),
            intervals,
        };
        let horizon = Horizon::solved(&ahead);
        let horizon =
            horizon.map_err(|error| CommandError::in_file(input)(error.at("control", "")))?;
        Ok(Self {
            horizon,
            system: ahead.system,
        })
    }

    /// Names of all that is measured, the state or the readings of its observer, with their units: rad, m, rad/s, m/s.
    pub fn measured(&self) -> Vec<(String, &'static str)> {
        let law = self.horizon.law();
        let of_state = |one: &Measured| {
            let unit = unit_of(one).0;
            match one.is_rate {
                true => (format!("rate of {}", one.name), unit),
                false => (one.name.clone(), unit),
            }
        };
        let reading = |one: &Reading| match one {
            Reading::State(place) => of_state(&law.measured[*place]),
            Reading::Marker(name, axis) => (format!("{name}.{}", ["x", "y", "z"][*axis]), "m"),
        };
        match &law.observer {
            Some(observer) => observer.readings.iter().map(reading).collect(),
            None => law.measured.iter().map(of_state).collect(),
        }
    }

    /// Factors of all that is measured from the units inside.
    fn factors(&self) -> Vec<f64> {
        let law = self.horizon.law();
        match &law.observer {
            Some(observer) => {
                let all = observer.readings.iter();
                all.map(|one| factor_of(one, &law.measured)).collect()
            }
            None => law.measured.iter().map(|one| unit_of(one).1).collect(),
        }
    }

    /// Names of the inputs, with their units.
    pub fn inputs(&self) -> Vec<(String, &'static str)> {
        let names = self.horizon.law().inputs.iter().map(|one| one.name.clone());
        names
            .zip(self.units())
            .map(|(name, (unit, _))| (name, unit))
            .collect()
    }

    /// Length of the intervals in s.
    pub fn interval(&self) -> f64 {
        self.horizon.law().h / 1e3
    }

    /// Units of the inputs, with their factors from those inside.
    fn units(&self) -> impl Iterator<Item = (&'static str, f64)> + '_ {
        let sources = self.system.sources();
        let inputs = self.horizon.law().inputs.iter();
        inputs.map(move |input| {
            let source = sources.iter().find(|source| source.name == input.name);
            source.map_or(("V", 1.0), |source| {
                let (unit, size) = source.kind.si();
                (unit, 1.0 / size)
            })
        })
    }
}

/// A controller in SI units.
#[derive(Debug)]
pub struct SiController<'h> {
    controller: RecedingHorizon<'h>,
    /// Factors to the units inside of what is measured, and of inputs from them.
    measured: Vec<f64>,
    inputs: Vec<f64>,
    /// Values of both.
    state: Vec<f64>,
    out: Vec<f64>,
}

impl<'h> SiController<'h> {
    /// A controller at the start of the motion.
    pub fn new(of: &'h FileHorizon) -> Self {
        let measured: Vec<f64> = of.factors().iter().map(|factor| 1.0 / factor).collect();
        let inputs: Vec<f64> = of.units().map(|(_, factor)| factor).collect();
        Self {
            controller: RecedingHorizon::new(&of.horizon),
            state: vec![0.0; measured.len()],
            out: vec![0.0; inputs.len()],
            measured,
            inputs,
        }
    }

    /// The inputs that act from a time in s on, or the delay of the feedback later, with what is measured there; none where it did not come in time. Called again within an interval, or at
    /// a time that is no finite number, it gives the same inputs.
    ///
    /// # Panics
    /// If there are more or fewer numbers than are measured.
    pub fn step(&mut self, time: f64, measured: Option<&[f64]>) -> (Source, &[f64]) {
        if let Some(measured) = measured {
            assert_eq!(measured.len(), self.state.len(), "all that is measured");
            let all = measured.iter().zip(&self.measured);
            let all = self.state.iter_mut().zip(all);
            all.for_each(|(to, (value, factor))| *to = value * factor);
        }
        let state = measured.map(|_| &*self.state);
        let answer = self.controller.step(1e3 * time, state);
        let all = answer.inputs.iter().zip(&self.inputs);
        let all = self.out.iter_mut().zip(all);
        all.for_each(|(to, (value, factor))| *to = value * factor);
        (answer.source, &self.out)
    }

    /// Prepares the next step, when the inputs went out.
    pub fn prepare(&mut self) {
        self.controller.prepare();
    }
}
