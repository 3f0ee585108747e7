//! Verification of optimal voltages: simulated forward from the start alone, with the step of the optimum and with finer
//! ones, then held at the goal's.
//!
//! The equations of a step have several roots where it does not resolve the motion; an optimum may have taken another one
//! than a step forward takes. On the grid of the optimum the simulation agrees with it to rounding, or it is another motion;
//! with finer steps it agrees as far as the grid resolves the motion. Steps that a simulation has to halve are finer ones.

use std::ops::ControlFlow;

use serde::Serialize;

use crate::control::{BoundaryConditions, Solution};
use crate::dynamics::{DiscreteTrajectory, Start, StepError, simulate};
use crate::ipopt::interrupt;
use crate::model::Model;
use crate::model::system::JointKind;
use crate::workflow::distance::Distance;
use crate::workflow::motion::solved;

/// Durations of the motion for which the goal is held.
const HELD: usize = 5;
/// Distance from the optimum on its own grid that counts as none, in rad and lengths of the system, and in tolerances of the
/// solver.
const SAME: (f64, f64) = (1e-4, 1e2);
/// A distance that grows by this factor within one step is no growth of rounding.
const JUMP: f64 = 1e3;
/// Estimated errors along the motion, as parts of its path length, from which on it is warned, and refused.
const COARSE: f64 = 0.05;
const TOO_COARSE: f64 = 0.25;
/// Steps for an interval of the optimum that are tried.
const FINER: [usize; 5] = [2, 4, 8, 16, 32];
/// Estimates that differ by less than this part of the greater one agree, and those below rounding.
const AGREE: f64 = 0.2;
const ROUNDING: f64 = 1e-7;
/// An estimated error beyond this part of the path length needs no better estimate.
const LOST: f64 = 1.0;
/// A drift from the goal, as a part of the path length, from which on it is not held.
const DRIFTS: f64 = 0.05;

/// What became of optimal voltages.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Resimulation {
    /// Greatest deviation from the optimal motion at its instants, with its step.
    pub deviation: Distance,
    /// The longest path of a joint, and of a body or node, along the optimal motion.
    pub path_length: Distance,
    /// The same voltages with finer steps.
    pub finer: Vec<Finer>,
    /// Estimated greatest distance of the optimal motion from the one that its voltages drive, as a part of the path length; absent
    /// where a simulation ended early.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub error: Option<f64>,
    /// Whether two estimates of that error agree.
    pub is_confirmed: bool,
    /// Time for which the voltages of the goal are held afterwards in s; absent where they are not known.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub held: Option<f64>,
    /// Greatest drift from the last optimal instant in that time.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub drift: Option<Distance>,
    /// Why it ended early.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub failure: Option<String>,
    /// Why the optimum is no motion of the system.
    #[serde(skip)]
    pub cause: Option<Cause>,
    /// The motion with half the step, where there is one.
    #[serde(skip)]
    pub(crate) half: Option<DiscreteTrajectory>,
    /// Where the motion with the step of the optimum ends.
    #[serde(skip)]
    end: Option<Start>,
}

/// A simulation with a part of the step of the optimum.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Finer {
    /// Number of steps for an interval of the optimum.
    pub steps: usize,
    /// Greatest deviation from the optimal motion at its instants.
    pub deviation: Distance,
    /// Why it ended early.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub failure: Option<String>,
}

/// Why an optimum of the discrete equations is no motion of the system.
#[derive(Clone, Debug, PartialEq)]
pub enum Cause {
    /// In one interval it is another root of the equations of a step than a step forward finds.
    Root {
        /// The interval, from 0.
        interval: usize,
        /// Its time in s.
        time: f64,
        /// The joint that turns farthest in it, and by how much in rad.
        turns: Option<(String, f64)>,
        /// How far the simulation is from the optimum after it.
        distance: Distance,
    },
    /// A simulation with so many steps for an interval ends early.
    Ends {
        /// Steps for an interval.
        steps: usize,
        /// Why.
        failure: String,
    },
    /// Rounding grows until the motion is another one.
    Unstable {
        /// Rate of growth in 1/s.
        rate: f64,
        /// Greatest distance from the optimum.
        distance: Distance,
    },
    /// The grid does not resolve the motion.
    Coarse {
        /// Estimated error as a part of the path length.
        error: f64,
        /// Greatest distance from the optimum with finer steps.
        distance: Distance,
        /// Whether two refinements agree on it.
        is_confirmed: bool,
    },
}

/// Simulates optimal voltages; what the solver of a `tolerance` leaves of its equations is no deviation.
pub(crate) fn resimulate(
    model: &Model,
    start: &Start,
    optimal: &Solution,
    tolerance: f64,
) -> Resimulation {
    let path_length = Distance::path_length(model, optimal);
    let own = Repeat::of(model, start, optimal, 1);
    let mut out = Resimulation {
        deviation: own.greatest(),
        path_length,
        finer: Vec::new(),
        error: None,
        is_confirmed: false,
        held: None,
        drift: None,
        failure: own.failure.clone(),
        cause: own.cause(model, optimal, SAME.0.max(SAME.1 * tolerance)),
        half: None,
        end: None,
    };
    if own.failure.is_some() || out.cause.is_some() {
        return out;
    }
    let least = match own.is_halved {
        true => own.greatest().over(path_length, model),
        false => 0.0_f64,
    };
    if !out.refine(model, start, optimal, least) {
        return out;
    }
    let last = own.history.z.len() - 1;
    out.end = Some(Start {
        z: own.history.z[last].clone(),
        momentum: own.history.momenta[last].clone(),
        rates: None,
    });
    out
}

impl Resimulation {
    /// Estimates the error with finer and finer steps until two estimates agree; whether no simulation ended early.
    fn refine(&mut self, model: &Model, start: &Start, optimal: &Solution, least: f64) -> bool {
        let with = |steps: usize| Repeat::of(model, start, optimal, steps);
        // Two estimates at the least, at once.
        let (half, quarter) = rayon::join(|| with(FINER[0]), || with(FINER[1]));
        let mut ready = vec![quarter, half];
        let mut estimates: Vec<f64> = Vec::new();
        let mut is_confirmed = false;
        for steps in FINER {
            let repeat = ready.pop().unwrap_or_else(|| with(steps));
            let deviation = repeat.greatest();
            self.finer.push(Finer {
                steps,
                deviation,
                failure: repeat.failure.clone(),
            });
            if let Some(failure) = repeat.failure {
                self.cause = Some(Cause::Ends { steps, failure });
                return false;
            }
            if steps == FINER[0] {
                self.half = Some(repeat.history);
            }
            // Errors of second order leave this part of the deviation.
            let square = (steps * steps) as f64;
            let estimate = square / (square - 1.0) * deviation.over(self.path_length, model);
            let before = estimates.last().copied();
            estimates.push(estimate);
            is_confirmed = before.is_some_and(|before| agree(before, estimate));
            if is_confirmed || (before.is_some() && estimate > LOST) {
                break;
            }
        }
        let error = match is_confirmed {
            true => estimates.last().copied().unwrap_or_default(),
            false => estimates.iter().copied().fold(0.0, f64::max),
        };
        let error = error.max(least);
        self.error = Some(error);
        self.is_confirmed = is_confirmed;
        let allowed = if is_confirmed {
            TOO_COARSE
        } else {
            0.5 * TOO_COARSE
        };
        let greatest = self.finer.iter().map(|finer| finer.deviation);
        let distance = greatest.fold(Distance::default(), Distance::max);
        if error > allowed {
            self.cause = Some(Cause::Coarse {
                error,
                distance,
                is_confirmed,
            });
        }
        true
    }

    /// Holds the voltages of the goal, where they are known and the motion came to its end.
    pub(crate) fn hold(
        &mut self,
        model: &Model,
        boundary: &BoundaryConditions,
        optimal: &Solution,
    ) {
        let (Some(end), Some(rest)) = (&self.end, &boundary.rest[1]) else {
            return;
        };
        let n = optimal.intervals();
        let h = optimal.times[n] / n as f64;
        let scalars = model.scalars(rest);
        let constant = |_: f64, _: f64| scalars.clone();
        let (history, failure) = simulate(model, end, h, HELD * n, constant, |_| go_on());
        let motion = solved(model, &history, None);
        let of = |k: usize| Distance::between(model, &motion, k, optimal, n);
        let drift = (0..motion.times.len()).map(of);
        self.drift = Some(drift.fold(Distance::default(), Distance::max));
        self.held = Some((HELD * n) as f64 * h / 1e3);
        self.failure = failure.map(|error| error.to_string());
    }

    /// Whether the goal is held: its voltages are known, and under them the system stays.
    pub(crate) fn is_held(&self, model: &Model) -> bool {
        let stays = |drift: Distance| drift.over(self.path_length, model) <= DRIFTS;
        self.failure.is_none() && self.drift.is_some_and(stays)
    }

    /// That the grid is coarse, or that the motion under the voltages could not be simulated.
    pub(crate) fn warning(&self) -> Option<String> {
        if let (None, None, Some(failure)) = (&self.cause, self.error, &self.failure) {
            return Some(format!(
                "the motion under the optimal voltages could not be simulated: {failure}"
            ));
        }
        let error = self.error.filter(|_| self.cause.is_none())?;
        let Finer { deviation, .. } = self.finer.last()?;
        if !self.is_confirmed {
            return Some(format!(
                "how far the motion under the optimal voltages deviates from the optimum is not known: finer steps lead elsewhere each \
                 time, by up to {:.0} % of the path length so far ({deviation}); use more intervals, or --accuracy",
                100.0 * error
            ));
        }
        if error <= COARSE {
            return None;
        }
        Some(format!(
            "the intervals are long for this motion: under the same voltages the motion with finer steps deviates from it by up to \
             {:.0} % of the path length ({deviation}); use more intervals, or --accuracy",
            100.0 * error
        ))
    }
}

/// Whether two estimates of an error confirm each other.
fn agree(one: f64, other: f64) -> bool {
    let greater = one.max(other);
    greater < ROUNDING || (one - other).abs() <= AGREE * greater
}

/// A simulation under optimal voltages, with so many steps for an interval.
struct Repeat {
    history: DiscreteTrajectory,
    /// Distances from the optimum at its instants, as far as it goes.
    distances: Vec<Distance>,
    failure: Option<String>,
    /// Whether some of its steps had to be halved.
    is_halved: bool,
    /// Whether redundant constraints keep a step forward from being taken at all.
    is_untestable: bool,
}

impl Repeat {
    fn of(model: &Model, start: &Start, optimal: &Solution, steps: usize) -> Self {
        let n = optimal.intervals();
        let h = optimal.times[n] / n as f64;
        let scalars = |from: f64, to: f64| {
            let k = (0.5 * (from + to) / h) as usize;
            model.scalars(&optimal.voltages[k.min(n - 1)])
        };
        let step = h / steps as f64;
        let (history, failure) = simulate(model, start, step, steps * n, scalars, |_| go_on());
        let motion = solved(model, &history, None);
        let instants = 0..=history.intervals() / steps;
        let of = |k: usize| Distance::between(model, &motion, steps * k, optimal, k);
        let ended = (history.intervals() < steps * n).then(|| "interrupted".to_owned());
        let is_untestable = history.intervals() == 0
            && matches!(&failure, Some(StepError::Singular { redundant, .. }) if !redundant.is_empty());
        Self {
            is_untestable,
            is_halved: history.report.halved > 0,
            distances: instants.map(of).collect(),
            failure: failure.map(|error| error.to_string()).or(ended),
            history,
        }
    }

    fn greatest(&self) -> Distance {
        let all = self.distances.iter().copied();
        all.fold(Distance::default(), Distance::max)
    }

    /// Why a simulation with the step of the optimum is another motion, where it is by more than `same`.
    fn cause(&self, model: &Model, optimal: &Solution, same: f64) -> Option<Cause> {
        if self.is_halved && self.failure.is_none() {
            return None;
        }
        let sizes: Vec<f64> = self.distances.iter().map(|d| d.size(model)).collect();
        let Some(k) = sizes.iter().position(|&size| size > same || size.is_nan()) else {
            let failure = self.failure.clone().filter(|_| !self.is_untestable)?;
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
fn go_on() -> ControlFlow<()> {
    match interrupt::requested() {
        true => ControlFlow::Break(()),
        false => ControlFlow::Continue(()),
    }
}

impl Cause {
    /// In words.
    pub(crate) fn told(&self) -> String {
        match self {
            Self::Root {
                interval,
                time,
                turns,
                distance,
            } => {
                let turn = turns.as_ref().map_or(String::new(), |(joint, angle)| {
                    format!(", where joint \"{joint}\" turns by {angle:.2} rad")
                });
                format!(
                    "forward simulation under the optimal voltages gives another motion: in interval {interval} (from \
                     {time:.4} s){turn}, the equations have several roots, and the optimum has another one than a forward step \
                     ({distance} apart after it); the intervals are too long for the motion"
                )
            }
            Self::Ends { steps: 1, failure } => {
                format!("forward simulation under the optimal voltages ends early: {failure}")
            }
            Self::Ends { steps, failure } => format!(
                "forward simulation under the optimal voltages with {steps} steps per interval ends early: {failure}"
            ),
            Self::Unstable { rate, distance } => format!(
                "forward simulation under the optimal voltages leaves the optimum ({distance}): the motion is unstable, round-off grows at a rate of {rate:.3} 1/s"
            ),
            Self::Coarse {
                error,
                distance,
                is_confirmed,
            } => {
                let further = match is_confirmed {
                    true => "",
                    false => {
                        "; steps that are still finer lead elsewhere, so that more is possible"
                    }
                };
                format!(
                    "the intervals do not resolve the motion: under the same voltages the motion with finer steps deviates \
                     from it by up to {:.0} % of the path length ({distance}){further}",
                    100.0 * error
                )
            }
        }
    }
}

/// The motion under the constant voltages of the goal, for `durations` times as long as the optimal one.
pub fn under_constant_voltages(
    model: &Model,
    boundary: &BoundaryConditions,
    optimal: &Solution,
    durations: usize,
) -> Option<(DiscreteTrajectory, Option<StepError>)> {
    let scalars = model.scalars(boundary.rest[1].as_ref()?);
    let n = optimal.intervals();
    let h = optimal.times[n] / n as f64;
    let constant = |_: f64, _: f64| scalars.clone();
    let start = &boundary.start;
    Some(simulate(model, start, h, durations * n, constant, |_| {
        ControlFlow::Continue(())
    }))
}
