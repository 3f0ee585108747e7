//! Simulations under optimal voltages, with a number of steps for each interval.

use std::ops::ControlFlow;

use crate::control::Solution;
use crate::control::problem::Control;
use crate::dynamics::{DiscreteTrajectory, Start, simulate};
use crate::math::Signal;
use crate::model::Model;
use crate::model::system::JointKind;
use crate::stop;
use crate::workflow::distance::Distance;
use crate::workflow::motion::solved;
use crate::workflow::reasons::Cause;

/// A distance that grows by this factor within one step is no growth of rounding.
const JUMP: f64 = 1e3;

/// A simulation under optimal voltages, with this number of steps for an interval.
pub(crate) struct Repeat {
    pub(crate) discrete: DiscreteTrajectory,
    motion: Solution,
    /// Distances from the optimum at its instants, as far as it goes.
    distances: Vec<Distance>,
    pub(crate) failure: Option<String>,
    /// True if some of its steps had to be halved.
    pub(crate) is_halved: bool,
}

impl Repeat {
    /// Simulates with inputs that are sought as in the optimum; those that are given follow their functions of time from step to step.
    pub(crate) fn from_solution(
        (model, control): (&Model, &Control),
        start: &Start,
        optimal: &Solution,
        steps: usize,
    ) -> Self {
        let n = optimal.intervals();
        let h = optimal.times[n] / n as f64;
        let given = given_functions(control, model, steps);
        let scalars = |from: f64, to: f64| {
            let time = 0.5 * (from + to);
            let k = (time / h) as usize;
            let mut scalars = model.scalars(&optimal.voltages[k.min(n - 1)]);
            for (scalar, function) in &given {
                scalars[*scalar] = function.at(time);
            }
            scalars
        };
        let step = h / steps as f64;
        let (discrete, failure) = simulate(model, start, step, steps * n, scalars, |_| go_on());
        let motion = solved(model, &discrete, None);
        let instants = 0..=discrete.intervals() / steps;
        let of = |k: usize| Distance::between(model, &motion, steps * k, optimal, k);
        let ended = (discrete.intervals() < steps * n).then(|| "interrupted".to_owned());
        Self {
            is_halved: discrete.report.halved > 0,
            distances: instants.map(of).collect(),
            failure: failure.map(|error| error.to_string()).or(ended),
            discrete,
            motion,
        }
    }

    /// Greatest distance from the same motion in half the steps, at all its instants: between those of the optimum a vibration that the steps
    /// do not resolve shows.
    pub(crate) fn apart(&self, model: &Model, half: &Self) -> Distance {
        let of = |k: usize| Distance::between(model, &self.motion, k, &half.motion, 2 * k);
        let all = (0..self.motion.times.len()).map(of);
        all.fold(Distance::default(), Distance::max)
    }

    /// Path length over the instants of the optimum, each of whose intervals has this number of steps.
    pub(crate) fn path_length(&self, model: &Model, steps: usize) -> Distance {
        Distance::path_length_by(model, &self.motion, steps)
    }

    pub(crate) fn greatest(&self) -> Distance {
        let all = self.distances.iter().copied();
        all.fold(Distance::default(), Distance::max)
    }

    /// Returns the reason why a simulation with the step of the optimum is another motion, where it is by more than `same`.
    pub(crate) fn cause(&self, model: &Model, optimal: &Solution, same: f64) -> Option<Cause> {
        if self.is_halved && self.failure.is_none() {
            return None;
        }
        let sizes: Vec<f64> = self.distances.iter().map(|d| d.size(model)).collect();
        let Some(k) = sizes.iter().position(|&size| size > same || size.is_nan()) else {
            let failure = self.failure.clone()?;
            return Some(Cause::Ends { steps: 1, failure });
        };
        let k = k.max(1);
        let before = sizes[k - 1].max(f64::EPSILON);
        if sizes[k] >= JUMP * before || sizes[k].is_nan() {
            return Some(Cause::Root {
                interval: k - 1,
                time: optimal.times[k - 1] / 1e3,
                turns: turns(model, optimal, k),
                distance: self.distances[k],
            });
        }
        let first = sizes
            .iter()
            .position(|&size| size > f64::EPSILON)
            .unwrap_or(k);
        let elapsed = (optimal.times[k] - optimal.times[first.min(k - 1)]) / 1e3;
        Some(Cause::Unstable {
            rate: (sizes[k] / sizes[first.min(k - 1)].max(f64::EPSILON)).ln() / elapsed,
            distance: self.greatest(),
        })
    }
}

/// Scalars of an interval that are functions of time, which steps shorter than an interval resolve better than the optimum does.
fn given_functions<'a>(
    control: &'a Control,
    model: &Model,
    steps: usize,
) -> Vec<(usize, &'a Signal)> {
    let sources = (0..model.sources.len()).filter(|_| steps > 1);
    let scalar = |source| Some((model.variables.input(source)?, control.function(source)?));
    sources.filter_map(scalar).collect()
}

/// The joint that turns farthest in the interval that ends at instant `k`.
fn turns(model: &Model, motion: &Solution, k: usize) -> Option<(String, f64)> {
    let [a, b] = [&motion.joints[k - 1], &motion.joints[k]];
    let angles = a.iter().zip(b).map(|(a, b)| (a - b).abs());
    let joints = model.system.joints.iter().zip(angles);
    let turning = joints.filter(|(joint, _)| matches!(joint.kind, JointKind::Revolute { .. }));
    let (joint, angle) = turning.max_by(|a, b| a.1.total_cmp(&b.1))?;
    Some((joint.name.clone(), angle))
}

/// Goes on unless Ctrl-C asks to stop.
pub(crate) fn go_on() -> ControlFlow<()> {
    match stop::requested() {
        true => ControlFlow::Break(()),
        false => ControlFlow::Continue(()),
    }
}
