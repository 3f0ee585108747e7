//! Verification of optimal voltages: simulated forward from the start alone, with the step of the optimum and with finer
//! ones, then held at the goal's.
//!
//! The equations of a step have several roots where it does not resolve the motion; an optimum may have taken another one
//! than a step forward takes. On the grid of the optimum the simulation agrees with it to rounding, or it is another motion;
//! with finer steps it agrees as far as the grid resolves the motion. Steps that a simulation has to halve are finer ones.

use crate::control::problem::Control;
use crate::control::{BoundaryConditions, Solution};
use crate::dynamics::{DiscreteTrajectory, Start, StepError, simulate};
use crate::model::system::JointKind;
use crate::model::{Model, OPEN};
use crate::stop;
use crate::workflow::motion::{Distance, solved};
use crate::workflow::reasons::Cause;
use serde::Serialize;
use std::ops::ControlFlow;

/// Distance from the optimum on its own grid that counts as none, in rad and lengths of the system, and in tolerances of the
/// solver.
const SAME: (f64, f64) = (1e-4, 1e2);
/// Estimated errors along the motion, as parts of its path length, from which on it is warned, and refused.
const COARSE: f64 = 0.05;
const TOO_COARSE: f64 = 0.25;
/// Steps for an interval of the optimum that are tried.
const FINER: [usize; 5] = [2, 4, 8, 16, 32];
/// A distance between two refinements that is at most this part of the one before falls as the order of the method demands.
const FALLS: f64 = 0.5;
/// Remainder of an error after the last refinement, as a part of it.
const LEFT: f64 = 0.25;
/// Parts of the path length below this are rounding.
const ROUNDING: f64 = 1e-7;
/// An estimated error beyond this part of the path length needs no better estimate.
const LOST: f64 = 1.0;

/// Verification of optimal voltages.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Resimulation {
    /// Greatest deviation from the optimal motion at its instants, with its step.
    pub deviation: Distance,
    /// The longest path of a joint, and of a body or node, along the optimal motion or along that with finer steps, whichever is shorter.
    pub path_length: Distance,
    /// The same voltages with finer steps.
    pub finer: Vec<Finer>,
    /// Estimated greatest distance of the optimal motion from the one that its voltages drive, as a part of the path length; absent
    /// where a simulation ended early.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub error: Option<f64>,
    /// True if distances that fall from refinement to refinement confirm that error.
    pub is_confirmed: bool,
    /// Time for which the voltages of the goal are held afterwards in s; absent where they are not known.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub held: Option<f64>,
    /// Greatest drift from the last optimal instant in that time.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub drift: Option<Distance>,
    /// Reason why it ended early.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub failure: Option<String>,
    /// Reason why the optimum is not a motion of the system.
    #[serde(skip)]
    pub cause: Option<Cause>,
    /// The motion with half the step, where there is one.
    #[serde(skip)]
    pub(crate) half: Option<DiscreteTrajectory>,
    /// End of the motion with the step of the optimum.
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
    /// Reason why it ended early.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub failure: Option<String>,
}

/// The first instant of an optimum that opens a loop, beyond what the solver of a `tolerance` leaves of its equations.
fn open(model: &Model, optimal: &Solution, tolerance: f64) -> Option<Cause> {
    let allowed = OPEN.max(SAME.1 * tolerance);
    let mut instants = optimal.z.iter();
    let open = instants.find_map(|z| model.open_loop(z, allowed));
    open.map(|(constraint, gap)| Cause::Open { constraint, gap })
}

/// Simulations that verify a solution.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Verification {
    /// With the steps of the intervals, and with finer ones, which tell their error.
    Full,
    /// With the steps of the intervals alone.
    OwnSteps,
}

/// Simulates optimal voltages; what the solver of a `tolerance` leaves of its equations is no deviation.
pub(crate) fn resimulate(
    model: &Model,
    control: &Control,
    start: &Start,
    optimal: &Solution,
    tolerance: f64,
    verification: Verification,
) -> Resimulation {
    let path_length = Distance::path_length(model, optimal, 1);
    let repeat = |steps: usize| Repeat::from_solution(model, control, start, optimal, steps);
    let own = repeat(1);
    let mut out = Resimulation {
        deviation: own.greatest(),
        path_length,
        failure: own.failure.clone(),
        cause: open(model, optimal, tolerance)
            .or_else(|| own.cause(model, optimal, SAME.0.max(SAME.1 * tolerance))),
        ..Resimulation::default()
    };
    if own.failure.is_some() || out.cause.is_some() || verification == Verification::OwnSteps {
        return out;
    }
    let least = match own.discrete.report.halved > 0 {
        true => own.greatest().over(path_length, model),
        false => 0.0_f64,
    };
    if out.refine(model, repeat, least) {
        let DiscreteTrajectory {
            z, momenta, times, ..
        } = own.discrete;
        let last = z.len() - 1;
        out.end = Some(Start {
            z: z[last].clone(),
            momentum: momenta[last].clone(),
            rates: None,
            time: times[last],
        });
    }
    out
}

impl Resimulation {
    /// Estimates the error with finer and finer steps until their distances fall, of a large error twice in a row: a vibration that
    /// no step resolves may lie near by chance once. Returns true if no simulation ended early.
    fn refine(&mut self, model: &Model, with: impl Fn(usize) -> Repeat, least: f64) -> bool {
        let mut before: Option<(Repeat, f64)> = None;
        let mut greatest = Distance::default();
        let (mut error, mut is_confirmed, mut fallen) = (0.0, false, 0);
        for steps in FINER {
            let repeat = with(steps);
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
                self.half = Some(repeat.discrete.clone());
            }
            greatest = greatest.max(deviation);
            // An optimum on a coarse grid may zigzag: its own path says little of the motion that it stands for.
            let own_length = Distance::path_length(model, &repeat.motion, steps);
            self.path_length = self.path_length.min(own_length);
            let apart = match &before {
                Some((coarse, _)) => coarse.apart(model, &repeat),
                None => deviation,
            };
            let apart = apart.over(self.path_length, model);
            // What is left of an error of second order after this refinement.
            let left = apart / 3.0;
            error = deviation.over(self.path_length, model) + left;
            if let Some((_, last)) = &before {
                let falls = apart <= FALLS * last && left <= LEFT * error;
                fallen = if falls { fallen + 1 } else { 0 };
                let needed = if error > COARSE { 2 } else { 1 };
                is_confirmed = error.max(apart) < ROUNDING || fallen >= needed;
                if is_confirmed || error > LOST {
                    break;
                }
            }
            before = Some((repeat, apart));
        }
        if !is_confirmed {
            error = error.max(greatest.over(self.path_length, model));
        }
        let error = error.max(least);
        self.error = Some(error);
        self.is_confirmed = is_confirmed;
        let part = if is_confirmed { 1.0 } else { 0.5 };
        let allowed = part * TOO_COARSE;
        if error > allowed {
            self.cause = Some(Cause::Coarse {
                error,
                distance: greatest,
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
        let Held { drift, failure, .. } = held(model, end, optimal, rest);
        self.drift = Some(drift);
        let n = optimal.intervals();
        self.held = Some((DURATIONS * n) as f64 * (optimal.times[n] / n as f64) / 1e3);
        self.failure = failure.map(|error| error.to_string());
    }

    /// Returns true if the goal is held: its voltages are known, and under them the system stays.
    pub(crate) fn is_held(&self, model: &Model) -> bool {
        let stays = |drift| is_small(drift, self.path_length, model);
        self.failure.is_none() && self.drift.is_some_and(stays)
    }

    /// That the grid is coarse, or that the motion under the voltages could not be simulated.
    pub(crate) fn warning(&self) -> Option<String> {
        if let (None, None, Some(failure)) = (&self.cause, self.error, &self.failure) {
            let text = "the motion under the optimal inputs could not be simulated";
            return Some(format!("{text}: {failure}"));
        }
        let error = self.error.filter(|_| self.cause.is_none())?;
        let Finer { deviation, .. } = self.finer.last()?;
        if !self.is_confirmed {
            return Some(format!(
                "how far the motion under the optimal inputs deviates from the optimum is not known: finer steps lead elsewhere each \
                 time, by up to {:.0} % of the path length so far ({deviation}); use more intervals, or --accuracy",
                100.0 * error
            ));
        }
        if error <= COARSE {
            return None;
        }
        Some(format!(
            "the intervals are long for this motion: under the same inputs the motion with finer steps deviates from it by up to \
             {:.0} % of the path length ({deviation}); use more intervals, or --accuracy",
            100.0 * error
        ))
    }
}

/// A distance that grows by this factor within one step is no growth of rounding.
const JUMP: f64 = 1e3;

/// A simulation under optimal voltages, with this number of steps for an interval.
pub(crate) struct Repeat {
    pub(crate) discrete: DiscreteTrajectory,
    motion: Solution,
    /// Distances from the optimum at its instants, as far as it goes.
    distances: Vec<Distance>,
    pub(crate) failure: Option<String>,
}

impl Repeat {
    /// Simulates with inputs that are sought as in the optimum; those that are given follow their functions of time from step to step.
    pub(crate) fn from_solution(
        model: &Model,
        control: &Control,
        start: &Start,
        optimal: &Solution,
        steps: usize,
    ) -> Self {
        let n = optimal.intervals();
        let h = optimal.times[n] / n as f64;
        // Steps shorter than an interval resolve functions of time better than the optimum does.
        let sources = (0..model.sources.len()).filter(|_| steps > 1);
        let scalar = |source| Some((model.variables.input(source)?, control.function(source)?));
        let given: Vec<_> = sources.filter_map(scalar).collect();
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
        let (discrete, failure) =
            simulate(model, start, step, steps * n, scalars, |_| stop::go_on());
        let motion = solved(model, &discrete, None);
        let instants = 0..=discrete.intervals() / steps;
        let of = |k: usize| Distance::between(model, &motion, steps * k, optimal, k);
        let ended = (discrete.intervals() < steps * n).then(|| "interrupted".to_owned());
        Self {
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

    pub(crate) fn greatest(&self) -> Distance {
        let all = self.distances.iter().copied();
        all.fold(Distance::default(), Distance::max)
    }

    /// Returns the reason why a simulation with the step of the optimum is another motion, where it is by more than `same`.
    pub(crate) fn cause(&self, model: &Model, optimal: &Solution, same: f64) -> Option<Cause> {
        if self.discrete.report.halved > 0 && self.failure.is_none() {
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
        let first = sizes.iter().position(|&size| size > f64::EPSILON);
        let first = first.unwrap_or(k).min(k - 1);
        let elapsed = (optimal.times[k] - optimal.times[first]) / 1e3;
        Some(Cause::Unstable {
            rate: (sizes[k] / sizes[first].max(f64::EPSILON)).ln() / elapsed,
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

/// Durations of the optimum for which voltages are held.
pub(crate) const DURATIONS: usize = 5;
/// A drift from the goal, as a part of the path length, from which on it is not held.
const DRIFTS: f64 = 0.05;

/// The motion after an optimum.
pub(crate) struct Held {
    /// The motion, which begins at the end of the optimum.
    pub(crate) motion: Solution,
    /// Greatest drift from the last optimal instant.
    pub(crate) drift: Distance,
    /// The error with which the simulation ended early.
    pub(crate) failure: Option<StepError>,
}

/// Simulates the voltages of an instant, from the end of an optimum on.
pub(crate) fn held(model: &Model, end: &Start, optimal: &Solution, voltages: &[f64]) -> Held {
    let (discrete, failure) = constant(model, end, optimal, voltages, DURATIONS, stop::go_on);
    let motion = solved(model, &discrete, None);
    let n = optimal.intervals();
    let of = |k: usize| Distance::between(model, &motion, k, optimal, n);
    let drift = (0..motion.times.len()).map(of);
    Held {
        drift: drift.fold(Distance::default(), Distance::max),
        motion,
        failure,
    }
}

/// Simulates constant voltages with the mean step of an optimum, for a number of its durations.
pub(crate) fn constant(
    model: &Model,
    start: &Start,
    optimal: &Solution,
    voltages: &[f64],
    durations: usize,
    go_on: impl Fn() -> ControlFlow<()>,
) -> (DiscreteTrajectory, Option<StepError>) {
    let scalars = model.scalars(voltages);
    let n = optimal.intervals();
    let h = optimal.times[n] / n as f64;
    let constant = |_: f64, _: f64| scalars.clone();
    simulate(model, start, h, durations * n, constant, |_| go_on())
}

/// Returns true if a drift compared with a path is so small that the end counts as held.
pub(crate) fn is_small(drift: Distance, path_length: Distance, model: &Model) -> bool {
    drift.over(path_length, model) <= DRIFTS
}
