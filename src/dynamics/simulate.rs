//! Simulation: step after step, recorded.

use crate::dynamics::momenta::Start;
use crate::dynamics::solving::{Drive, Integrator, Solving};
use crate::dynamics::stepper::{Allowed, Equations, Steps};
use crate::dynamics::trajectory::{DiscreteTrajectory, Reading};
use crate::dynamics::{StepError, Stepper};
use crate::model::{Model, OPEN};
use std::ops::ControlFlow;

/// The shortest step that a tolerance may ask for, as a part of the duration.
const LEAST: f64 = 1e-9;
/// Part of a tolerance that the first two steps behind the start and behind all switches may use in excess.
const AT_JUMPS: f64 = 1e-3;

/// Integrates `steps` steps of `h` ms under the voltages of a drive.
///
/// After each step `observer` sees the motion so far and may end it; so may a [watch](crate::stop::watch), within a
/// step too.
///
/// The trajectory ends where a step fails; the error says why.
pub fn simulate(
    model: &Model,
    start: &Start,
    h: f64,
    steps: usize,
    drive: impl Drive,
    observer: impl FnMut(&DiscreteTrajectory) -> ControlFlow<()>,
) -> (DiscreteTrajectory, Option<StepError>) {
    simulate_by(Solving::default(), model, start, h, steps, drive, observer)
}

/// Integrates like [`simulate`], by the method and with the solution of its equations that `solving` names.
pub fn simulate_by(
    solving: Solving,
    model: &Model,
    start: &Start,
    h: f64,
    steps: usize,
    drive: impl Drive,
    observer: impl FnMut(&DiscreteTrajectory) -> ControlFlow<()>,
) -> (DiscreteTrajectory, Option<StepError>) {
    let lengths = Lengths::Equal { h, steps };
    let begun = DiscreteTrajectory::at(start);
    go_on(solving, model, begun, lengths, &drive, observer)
}

/// Equal steps, given ones, or steps that a tolerance controls.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Lengths<'a> {
    /// Equal ones.
    Equal {
        /// Length in ms.
        h: f64,
        /// Number of steps.
        steps: usize,
    },
    /// Steps between times in ms that grow from zero.
    Between(&'a [f64]),
    /// By their local error.
    Controlled(StepControl<'a>),
}

/// Lengths of steps that a tolerance controls, by the midpoint rule: their local error, by the change of the last rates, stays below a tolerance
/// per time. Steps of unequal length keep momentum maps, and no longer the energy over long times.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepControl<'a> {
    /// Length of the motion in ms.
    pub duration: f64,
    /// Length in ms of the first attempt.
    pub first: f64,
    /// Sum of the local errors that is allowed over the duration: of angles in rad, of lengths relative to the system's.
    pub tolerance: f64,
    /// Times in ms, growing, at which voltages may switch: steps end there.
    pub switches: &'a [f64],
}

/// Resumes a motion that has begun, up to the number of steps or the duration of the whole: it becomes what it would have become without
/// a stop, to the bit.
///
/// `drive` and `observer` are as in [`simulate`]. Where the motion is not one of this model by this method it stays as it is, and the error
/// says so.
pub fn go_on(
    solving: Solving,
    model: &Model,
    mut discrete: DiscreteTrajectory,
    lengths: Lengths<'_>,
    drive: &dyn Drive,
    observer: impl FnMut(&DiscreteTrajectory) -> ControlFlow<()>,
) -> (DiscreteTrajectory, Option<StepError>) {
    if !discrete.is_of(model) {
        let time = discrete.times.last().copied().unwrap_or(0.0);
        return (discrete, Some(StepError::Foreign { time }));
    }
    let start = Start {
        z: discrete.z[0].clone(),
        momentum: discrete.momenta[0].clone(),
        rates: discrete.rates.clone(),
        time: discrete.begun,
    };
    let is_midpoint = solving.integrator == Integrator::Midpoint;
    discrete.reading = match is_midpoint {
        true => Reading::Intervals,
        false => Reading::Instants,
    };
    let failure = match (lengths.first(), is_midpoint) {
        (Some(first), false) => match Steps::stages(model, &start, solving, first, drive) {
            Ok(mut stages) => record(&mut stages, lengths, drive, observer, &mut discrete),
            Err(error) => Some(error),
        },
        _ => {
            let mut stepper = Stepper::new(model, &start.z, &start.momentum, solving);
            stepper.equations.time = start.time;
            if let (Lengths::Controlled(_), Some(rates)) = (lengths, &start.rates) {
                stepper.equations.rates.copy_from_slice(rates);
            }
            record(&mut stepper, lengths, drive, observer, &mut discrete)
        }
    };
    (discrete, failure)
}

impl DiscreteTrajectory {
    /// A motion that begins.
    pub fn at(start: &Start) -> Self {
        Self {
            times: vec![0.0],
            z: vec![start.z.clone()],
            momenta: vec![start.momentum.clone()],
            rates: start.rates.clone(),
            begun: start.time,
            ..Self::default()
        }
    }

    /// Returns true if its lists have the lengths of a motion of this model.
    fn is_of(&self, model: &Model) -> bool {
        let (instants, intervals) = (self.times.len(), self.scalars.len());
        let map = &model.action.map;
        let have = |rows: &[Vec<f64>], length: usize| rows.iter().all(|row| row.len() == length);
        let n = map.coordinates;
        instants == intervals + 1
            && [self.z.len(), self.momenta.len()] == [instants; 2]
            && have(&self.z, map.instant().z.len())
            && have(&self.momenta, n)
            && have(&self.scalars, model.action.intervals.scalars)
            && (self.ends.is_empty() || self.ends.len() == intervals)
            && self.rates.as_ref().is_none_or(|rates| rates.len() == n)
            && self.z.iter().all(|z| map.has_unit_charts(z))
    }

    /// Takes in the step between two times in ms, with the voltages in its middle.
    fn push<E: Equations>(&mut self, step: [f64; 2], stepper: &mut Steps<E>, drive: &dyn Drive) {
        self.times.push(step[1]);
        self.z.push(stepper.coordinates().to_vec());
        self.momenta.push(stepper.momentum().to_vec());
        let mut scalars = stepper.scalars().to_vec();
        let inputs = stepper.equations.model().variables.inputs();
        scalars[inputs].copy_from_slice(&drive.at(step, 0.5));
        self.scalars.push(scalars);
        self.ends.extend(drive.ends(step));
        self.works.extend(stepper.work());
        stepper.keep(&mut self.end);
    }
}

impl Lengths<'_> {
    /// Length in ms of the first step, where it is given.
    fn first(self) -> Option<f64> {
        self.step(0).map(|[from, to, _]| to - from)
    }

    /// Both times and the length in ms of a step that is given.
    fn step(self, k: usize) -> Option<[f64; 3]> {
        match self {
            Self::Equal { h, steps } => (k < steps).then(|| [k as f64 * h, (k + 1) as f64 * h, h]),
            Self::Between(times) => {
                let (from, to) = (*times.get(k)?, *times.get(k + 1)?);
                Some([from, to, to - from])
            }
            Self::Controlled(_) => None,
        }
    }
}

/// A step that was taken between two times in ms.
struct Taken {
    step: [f64; 2],
    /// Multipliers at its start.
    multipliers: Vec<f64>,
    /// Length in ms that the next one may have, where a tolerance controls it.
    wanted: Option<f64>,
}

/// Takes steps of these lengths and records them; returns why they end early.
fn record<E: Equations>(
    stepper: &mut Steps<E>,
    lengths: Lengths<'_>,
    drive: &dyn Drive,
    mut observer: impl FnMut(&DiscreteTrajectory) -> ControlFlow<()>,
    discrete: &mut DiscreteTrajectory,
) -> Option<StepError> {
    let n = stepper.momentum().len();
    let mut failure = None;
    let done = discrete.intervals();
    if !stepper.take(&discrete.end) {
        let time = discrete.times[done];
        return Some(StepError::Foreign { time });
    }
    for k in done.. {
        let taken = match lengths {
            Lengths::Controlled(control) => control.step(stepper, drive, discrete),
            given => given.step(k).map(|[from, to, h]| {
                let multipliers = stepper.go([from, to], h, drive);
                multipliers.map(|multipliers| Taken {
                    step: [from, to],
                    multipliers,
                    wanted: discrete.end.wanted,
                })
            }),
        };
        match taken {
            None | Some(Err(StepError::Stopped { .. })) => break,
            Some(Err(error)) => failure = Some(error),
            Some(Ok(taken)) => {
                let multipliers = taken.multipliers;
                discrete.z[k][n..n + multipliers.len()].copy_from_slice(&multipliers);
                discrete.push(taken.step, stepper, drive);
                discrete.end.wanted = taken.wanted;
                failure = open_loop(stepper, discrete);
            }
        }
        if failure.is_some() || observer(discrete).is_break() {
            break;
        }
    }
    discrete.report = stepper.report();
    discrete.solver = stepper.solver();
    failure
}

impl StepControl<'_> {
    /// Takes the next step of a motion; `None` at its end.
    fn step<E: Equations>(
        self,
        stepper: &mut Steps<E>,
        drive: &dyn Drive,
        discrete: &mut DiscreteTrajectory,
    ) -> Option<Result<Taken, StepError>> {
        let Self {
            duration, switches, ..
        } = self;
        let k = discrete.intervals();
        let time = discrete.times[k];
        let wanted = discrete.end.wanted.unwrap_or(self.first);
        let tolerance = *discrete.end.tolerance.get_or_insert(self.tolerance);
        if time >= duration * (1.0 - 1e-12) {
            return None;
        }
        let mut later = switches.iter().filter(|&&at| at > time * (1.0 + 1e-12));
        let end = later.next().copied().unwrap_or(duration).min(duration);
        let left = end - time;
        let mut earlier = switches.iter().filter(|&&at| at <= time * (1.0 + 1e-12));
        let begin = earlier.next_back().copied().unwrap_or(0.0);
        // The last two steps before an end share what is left, and there are two between any two ends.
        let h = match left / wanted {
            parts if parts <= 1.0 && time > begin => left,
            parts if parts < 2.0 => 0.5 * left,
            _ => wanted,
        };
        let to = if h == left { end } else { time + h };
        // Behind a jump of voltages the change of the rates says more than the error: two steps may use a part of the tolerance.
        let is_behind = k < 2 || discrete.times[k - 1] <= begin * (1.0 + 1e-12);
        let at_jump = match is_behind {
            true => AT_JUMPS * tolerance / (1 + switches.len()) as f64,
            false => 0.0,
        };
        let allowed = Allowed {
            shortest: LEAST * duration,
            error_per_ms: tolerance / duration,
            error: at_jump,
        };
        let taken = stepper.step_within([time, to], h, allowed, drive);
        Some(taken.map(|[taken, next]| Taken {
            step: [time, if taken == left { end } else { time + taken }],
            multipliers: stepper.equations.now().multipliers.to_vec(),
            wanted: Some(if taken == h { next.max(wanted) } else { next }),
        }))
    }
}

/// The failure of a motion whose last instant violates a closing constraint that was left out.
fn open_loop<E: Equations>(stepper: &Steps<E>, discrete: &DiscreteTrajectory) -> Option<StepError> {
    let model = stepper.equations.model();
    let (constraint, gap) = model.open_loop(discrete.z.last()?, OPEN)?;
    Some(StepError::OpenLoop {
        time: discrete.times.last().copied()?,
        constraint,
        gap,
    })
}

/// Factor of a step whose local error, of third order, is `used` of the allowed error per time, with some room.
fn factor(used: f64) -> f64 {
    (0.9 / used.sqrt()).max(0.1)
}

impl<E: Equations> Steps<E> {
    /// Goes on between two times of the drive by at most all of the `h` ms, within limits; returns how far it went and how far it would go
    /// next.
    ///
    /// # Errors
    /// Steps down to the shortest one fail; the state is then that of the last accepted step.
    fn step_within(
        &mut self,
        [from, to]: [f64; 2],
        h: f64,
        allowed: Allowed,
        drive: &dyn Drive,
    ) -> Result<[f64; 2], StepError> {
        self.allowed = Some(allowed);
        let mut part = h;
        loop {
            let end = if part < h { from + part } else { to };
            self.equations.begin([from, end], drive);
            (self.used, self.touch) = (0.0, None);
            let error = match self.attempt(part) {
                Ok(()) => break,
                Err(stopped @ StepError::Stopped { .. }) => return Err(stopped),
                Err(error) => error,
            };
            if std::mem::take(&mut self.stale) || self.make_exact_after(&error) {
                self.factored = None;
                if self.used <= 1.0 && self.touch.is_none() {
                    continue;
                }
            }
            let by_error = match self.touch {
                Some(_) if self.used <= 1.0 => 1.0,
                _ => factor(self.used).min(0.5),
            };
            // A step ends where a contact begins or ends.
            let shorter = part * self.touch.map_or(by_error, |touch| touch.min(by_error));
            if shorter < allowed.shortest {
                if !self.updates.make_double() {
                    return Err(error);
                }
                (self.factored, part) = (None, h);
                continue;
            }
            self.report.halved += 1;
            part = shorter;
        }
        // A step that hardly changes keeps its factorisation.
        let next = match factor(self.used) {
            close if (1.0..1.3).contains(&close) => part,
            other => part * other.min(2.0),
        };
        Ok([part, next])
    }
}
