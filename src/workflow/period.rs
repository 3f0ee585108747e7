//! A periodic motion after its first period: its start, and how near it comes back under the same inputs.

use std::ops::ControlFlow;

use serde::Serialize;

use crate::control::problem::{BoundaryState, Control};
use crate::control::{BoundaryConditions, Solution};
use crate::dynamics::{Start, StepError, simulate};
use crate::math::significant;
use crate::model::Model;
use crate::stop;
use crate::workflow::distance::Distance;
use crate::workflow::held::is_small;
use crate::workflow::motion::solved;

/// Periods that are simulated.
const PERIODS: usize = 5;

/// The motion under the inputs of a periodic one, again and again.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Repeated {
    /// Number of periods that were simulated.
    pub periods: usize,
    /// Greatest distance from the same instant of the periodic motion.
    pub drift: Distance,
    /// Reason why the simulation ended early.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub failure: Option<String>,
    /// True if the motion comes back in every period.
    pub comes_back: bool,
}

/// Starts a periodic motion where it was found to start, with the inputs of its end before it.
pub(crate) fn begin(control: &Control, boundary: &mut BoundaryConditions, motion: &Solution) {
    if control.goal != BoundaryState::Periodic {
        return;
    }
    boundary.start = Start {
        z: motion.z[0].clone(),
        momentum: motion.momentum.clone(),
        rates: None,
        time: 0.0,
    };
    boundary.rest[0] = motion.voltages.last().cloned();
}

/// Simulates the inputs of a periodic motion again and again, with its step, and compares the drift with the length of its path; nothing
/// where joints have motions of their own, or a stop ends the first period.
pub(crate) fn repeated(
    model: &Model,
    control: &Control,
    start: &Start,
    optimal: &Solution,
    path_length: Distance,
) -> Option<Repeated> {
    // Prescribed motions go on as functions of time.
    if control.goal != BoundaryState::Periodic || !model.prescribed.is_empty() {
        return None;
    }
    let n = optimal.intervals();
    let h = optimal.times[n] / n as f64;
    let scalars = |from: f64, to: f64| {
        let k = (0.5 * (from + to) / h) as usize % n;
        model.scalars(&optimal.voltages[k])
    };
    let go_on = |_: &_| stop::check().map_or(ControlFlow::Break(()), ControlFlow::Continue);
    let (discrete, failure) = simulate(model, start, h, PERIODS * n, scalars, go_on);
    let failure = failure.filter(|error| !matches!(error, StepError::Stopped { .. }));
    let motion = solved(model, &discrete, None);
    // A stop within the first period leaves nothing to say.
    if failure.is_none() && motion.intervals() < n {
        return None;
    }
    let of = |k: usize| Distance::between(model, &motion, k, optimal, k % n);
    let drift = (0..motion.times.len()).map(of);
    let drift = drift.fold(Distance::default(), Distance::max);
    Some(Repeated {
        periods: motion.intervals() / n,
        drift,
        comes_back: failure.is_none() && is_small(drift, path_length, model),
        failure: failure.map(|error| error.to_string()),
    })
}

impl Repeated {
    /// That the motion comes back.
    pub(crate) fn note(&self) -> Option<String> {
        let Self { periods, drift, .. } = self;
        self.comes_back.then(|| {
            format!("the motion is periodic: after {periods} periods under the same inputs the state has drifted by {drift}")
        })
    }

    /// That it does not.
    pub(crate) fn warning(&self) -> Option<String> {
        let Self { periods, drift, .. } = self;
        let early = self.failure.as_ref();
        let early = early.map_or(String::new(), |failure| {
            format!(", and ends early: {failure}")
        });
        (!self.comes_back).then(|| {
            format!(
                "the periodic motion is not stable: after {} periods under the same inputs the state has drifted by {drift}{early}",
                significant(*periods as f64, 3)
            )
        })
    }
}
