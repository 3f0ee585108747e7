//! A state of rest that is asked for, and the vibrations about it.

use crate::control::required_analysis::zero_inputs;
use crate::model::system::System;
use crate::model::{Analysis, Coordinates, Quantity, Response};

/// A static equilibrium, or the path of equilibria that leads there.
#[derive(Clone, Debug, PartialEq)]
pub struct AtRest {
    /// Voltages in V, one per source.
    pub voltages: Vec<f64>,
    /// `None`: reduced.
    pub coordinates: Option<Coordinates>,
    /// Response of Maxwell branches.
    pub response: Response,
    /// Number of equilibria followed from zero voltage by arc length, past limit points; `None`: that under the voltages alone.
    pub path: Option<usize>,
    /// Vibrations about the state that are sought; `None`: none are.
    pub vibrations: Option<VibrationRequest>,
}

/// Vibrations about a state of rest that are sought.
#[derive(Clone, Debug, PartialEq)]
pub struct VibrationRequest {
    /// Number of vibrations, those of lowest frequencies.
    pub count: usize,
    /// An input that oscillates.
    pub sweep: Option<FrequencySweep>,
}

/// An input that oscillates at frequencies whose logarithms are evenly spaced.
#[derive(Clone, Debug, PartialEq)]
pub struct FrequencySweep {
    /// The source.
    pub source: usize,
    /// Lowest and highest frequency in kHz.
    pub range: [f64; 2],
    /// Number of frequencies.
    pub points: usize,
}

impl FrequencySweep {
    /// The frequencies in kHz.
    pub fn frequencies(&self) -> Vec<f64> {
        let [low, high] = self.range;
        let step = (high / low).ln() / (self.points - 1) as f64;
        (0..self.points)
            .map(|k| low * (step * k as f64).exp())
            .collect()
    }
}

impl AtRest {
    /// The same with this number of vibrations about the state, where one is given.
    #[must_use]
    pub fn with_modes(&self, count: Option<usize>) -> Self {
        let mut task = self.clone();
        if let Some(count) = count {
            let sweep = task.vibrations.and_then(|one| one.sweep);
            task.vibrations = Some(VibrationRequest { count, sweep });
            task.path = None;
        }
        task
    }

    /// The analysis of a state of rest. Its stability is computed too, that of unloaded parts included: nothing is taken to
    /// be still.
    pub fn analysis(&self, system: &System) -> Analysis {
        Analysis {
            coordinates: self.coordinates,
            zero_inputs: zero_inputs(system, |s| self.voltages[s] != 0.0, []),
            response: self.response,
            ..Analysis::of_rest()
        }
    }

    /// The analysis of motions about the state of rest, in which quantities are measured: anything may move.
    pub fn analysis_of_vibrations(&self, system: &System, quantities: Vec<Quantity>) -> Analysis {
        let request = self.vibrations.as_ref();
        let swept = request.and_then(|one| Some(one.sweep.as_ref()?.source));
        let acts = |s: usize| self.voltages[s] != 0.0 || swept == Some(s);
        Analysis {
            coordinates: self.coordinates,
            zero_inputs: zero_inputs(system, acts, []),
            quantities,
            ..Analysis::of_motion(1.0)
        }
    }
}
