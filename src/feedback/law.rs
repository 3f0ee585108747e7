//! A control law: a motion with its inputs, and gains that bring the system back to it.
//!
//! `u = u₀ − K (x − x₀)` with the inputs u₀ and the state x₀ of the motion: coordinates, their rates, and time integrals of deviations.
//! An input that acts by its square is u = V². Gains hold over an interval of the motion, or for the time after its end.
//!
//! An observer: the state of a system from quantities that do not tell all of it, by a Kalman filter about a motion.
//!
//! With deviations x of the state, y of what is measured and u of the inputs from the motion,
//!
//! ```text
//! x̂ = x̂⁻ + M (y − C x̂⁻),     x̂⁻₊ = A x̂ + B u.
//! ```
//!
//! Constant disturbances are entries of x behind the state.
//!
//! Constant disturbances that an observer finds, and the inputs that hold the goal against them.
//!
//! Of forces f on coordinates, which inputs u change by F u where the goal is held, the inputs against them are those within their bounds with the
//! least `|F u + f|`, by a bounded number of sweeps of coordinate descent that begin at those of the last sample.

use crate::feedback::held::product;
use nalgebra::DMatrix;

/// A quantity that is measured: a coordinate or the rate of one.
#[derive(Clone, Debug, PartialEq)]
pub struct Measured {
    /// Name of the coordinate.
    pub name: String,
    /// True for the rate.
    pub is_rate: bool,
    /// True for a length in mm, false for an angle in rad or a number.
    pub is_length: bool,
    /// The kind of what is remembered, which another system need not have; none of coordinates and rates of joints and nodes.
    pub memory: Option<Memory>,
}

/// Quantity that a muscle remembers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Memory {
    /// A number, as the logarithm of its viscous stretch.
    Number,
    /// Its charge, in a unit in mC.
    Charge(f64),
}

impl Memory {
    /// A value of what another law or system remembers, in the unit of this one.
    pub fn take(self, value: f64, from: Self) -> f64 {
        match (self, from) {
            (Self::Charge(to), Self::Charge(from)) => value * (from / to),
            _ => value,
        }
    }
}

/// An input that the law gives.
#[derive(Clone, Debug, PartialEq)]
pub struct LawInput {
    /// Name of the source.
    pub name: String,
    /// True if it acts by its square.
    pub is_squared: bool,
    /// Bounds of the input itself: V, N, N mm.
    pub bounds: [f64; 2],
}

/// Part of its range within which an input is at a bound; the barrier of plans keeps inputs off their bounds by less.
const AT_BOUND: f64 = 1e-4;

impl LawInput {
    /// An input with a correction, its bounds, and the input itself, all in the unit in which it acts: squares where it does by them.
    pub fn wanted(&self, given: f64, correction: f64) -> (f64, [f64; 2], f64) {
        // Of measured numbers so large that what follows is none.
        let correction = if correction.is_nan() { 0.0 } else { correction };
        let given = self.acting(given);
        let bounds = self.bounds.map(|bound| self.acting(bound));
        (given + correction, bounds, given)
    }

    /// A value of the input in the unit in which it acts.
    pub fn acting(&self, value: f64) -> f64 {
        match self.is_squared {
            true => value * value,
            false => value,
        }
    }

    /// The input with a correction, within its bounds.
    pub fn corrected(&self, given: f64, correction: f64) -> f64 {
        let (wanted, [low, high], _) = self.wanted(given, correction);
        let kept = wanted.clamp(low, high);
        if self.is_squared { kept.sqrt() } else { kept }
    }

    /// Returns true if a value is within 1e-4 of its range, of squares where it acts by them, of its lower (0) or upper (1) bound.
    pub fn is_at_bound(&self, value: f64, side: usize) -> bool {
        let (value, bounds, _) = self.wanted(value, 0.0);
        (value - bounds[side]).abs() <= AT_BOUND * (bounds[1] - bounds[0])
    }
}

/// The law in an interval, or after the end.
#[derive(Clone, Debug, PartialEq)]
pub struct Point {
    /// Measured quantities of the motion at the start of the interval: rad, mm, rad/ms, mm/ms.
    pub state: Vec<f64>,
    /// Inputs of the motion in the interval: V, N, N mm.
    pub inputs: Vec<f64>,
    /// K: by input, over the measured quantities, then constant disturbances and the inputs against them, then the integrals, then, interval by interval
    /// of the delay, the corrections of the inputs.
    pub gain: DMatrix<f64>,
    /// Correction whatever is measured, where a delay leads from the motion to the goal behind its end, which the motion does not quite reach; empty for none.
    pub offset: Vec<f64>,
}

/// Deviations whose integrals over time are fed back: they vanish where the system comes to rest.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Integral {
    /// Their places among the measured quantities.
    pub of: Vec<usize>,
}

/// A control law along a motion.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Law {
    /// Measured quantities.
    pub measured: Vec<Measured>,
    /// Inputs that follow from them.
    pub inputs: Vec<LawInput>,
    /// Deviations that are integrated.
    pub integral: Integral,
    /// Length of the intervals in ms.
    pub h: f64,
    /// Intervals from a measurement to its effect, over which the gains predict.
    pub delay: usize,
    /// One for each interval, in order.
    pub points: Vec<Point>,
    /// The state at the end of the motion and what holds it, where it is held.
    pub held: Option<Point>,
    /// The filter that finds the measured quantities from others, where they are not measured themselves.
    pub observer: Option<Observer>,
    /// Places of markers in mm at the instants of the motion, by name.
    pub markers: Vec<(String, Vec<[f64; 3]>)>,
}

impl Law {
    /// Number of quantities that are read at a sample: the measured ones, or those of the observer.
    pub fn readings(&self) -> usize {
        let own = self.measured.len();
        self.observer.as_ref().map_or(own, |one| one.readings.len())
    }

    /// Constant disturbances that its observer finds; nothing without them.
    pub fn lasting(&self) -> &[Forced] {
        let lasting = self.observer.as_ref().and_then(|one| one.lasting.as_ref());
        lasting.map_or(&[], |lasting| &lasting.on)
    }

    /// Number of constant disturbances that its observer finds.
    pub fn forces(&self) -> usize {
        self.lasting().len()
    }

    /// Number of inputs that act against constant disturbances: all of them, or none without forces.
    pub fn targets(&self) -> usize {
        if self.forces() > 0 { self.width() } else { 0 }
    }

    /// Number of measured quantities, constant disturbances, and inputs against them.
    pub(crate) fn estimated(&self) -> usize {
        self.measured.len() + self.forces() + self.targets()
    }

    /// Number of inputs.
    pub fn width(&self) -> usize {
        self.inputs.len()
    }

    /// Returns true if the goal is held after the end of the motion.
    pub fn holds_goal(&self) -> bool {
        self.held.is_some()
    }

    /// Length of the motion in ms.
    pub fn duration(&self) -> f64 {
        self.h * self.points.len() as f64
    }

    /// The law at a time in ms; the last one where the end is not held.
    pub fn at(&self, time: f64) -> &Point {
        let k = self.interval(time);
        let last = self.held.as_ref().or(self.points.last());
        self.points.get(k).or(last).expect("a law has an interval")
    }

    /// Writes the corrections of the inputs for a deviation, by the gain of a time in ms.
    pub fn correct(&self, time: f64, deviation: &[f64], correction: &mut [f64]) {
        let Point { gain, offset, .. } = self.at(time);
        for (input, value) in correction.iter_mut().enumerate() {
            *value = -product(gain, input, deviation);
        }
        let offsets = correction.iter_mut().zip(offset);
        offsets.for_each(|(value, offset)| *value += offset);
    }

    /// The interval of a time in ms; a time at its end, up to rounding, belongs to the next.
    pub fn interval(&self, time: f64) -> usize {
        (time / self.h + 1e-9).max(0.0) as usize
    }

    /// A time in ms with room for the rounding of that from which something acts.
    pub fn now(&self, time: f64) -> f64 {
        time + 1e-9 * (self.h + time.abs())
    }

    /// A place of a marker at a time in ms, between instants on the line between them.
    pub fn place(&self, places: &[[f64; 3]], time: f64) -> [f64; 3] {
        let last = places.len() - 1;
        let k = self.interval(time).min(last);
        let part = (time / self.h - k as f64).clamp(0.0, 1.0);
        let next = &places[(k + 1).min(last)];
        std::array::from_fn(|axis| places[k][axis] + part * (next[axis] - places[k][axis]))
    }

    /// The same motion without corrections.
    #[must_use]
    pub fn open(&self) -> Self {
        let mut out = self.clone();
        let points = out.points.iter_mut().chain(&mut out.held);
        points.for_each(|point| {
            point.gain.fill(0.0);
            point.offset.clear();
        });
        out
    }

    /// A measured quantity of the motion at a time in ms.
    pub fn reference(&self, time: f64, place: usize) -> f64 {
        let k = self.interval(time);
        let here = self.at(time).state[place];
        let part = time / self.h - k as f64;
        let next = match k < self.points.len() {
            true => self.at(self.h * (k + 1) as f64).state[place],
            false => here,
        };
        match part > 1e-9 {
            true => here + part * (next - here),
            false => here,
        }
    }
}

/// A quantity that an observer reads.
#[derive(Clone, Debug, PartialEq)]
pub enum Reading {
    /// A quantity of the state, by its place in the law.
    State(usize),
    /// A component, 0 to 2, of the place of a marker in mm, by the name of the marker.
    Marker(String, usize),
}

/// The filter in an interval, or after the end.
#[derive(Clone, Debug, PartialEq)]
pub struct Filter {
    /// Readings of the motion at the start of the interval: rad, mm.
    pub readings: Vec<f64>,
    /// A, over the measured quantities of the law, then the constant disturbances.
    pub by_state: DMatrix<f64>,
    /// B, over the inputs, or their squares.
    pub by_inputs: DMatrix<f64>,
    /// C.
    pub output: DMatrix<f64>,
    /// M.
    pub gain: DMatrix<f64>,
}

impl Filter {
    /// Corrects a predicted state by readings.
    pub(super) fn correct(&self, readings: &[f64], state: &mut [f64], errors: &mut [f64]) {
        for (row, error) in errors.iter_mut().enumerate() {
            let known = product(&self.output, row, state);
            let found = readings[row] - self.readings[row] - known;
            *error = if found.is_finite() { found } else { 0.0 };
        }
        for (i, x) in state.iter_mut().enumerate() {
            *x += product(&self.gain, i, errors);
        }
    }

    /// The state of the next interval.
    pub(super) fn predict(&self, state: &[f64], inputs: &[f64], next: &mut [f64]) {
        for (i, next) in next.iter_mut().enumerate() {
            *next = product(&self.by_state, i, state) + product(&self.by_inputs, i, inputs);
        }
    }
}

/// An observer along a motion.
#[derive(Clone, Debug, PartialEq)]
pub struct Observer {
    /// Its readings.
    pub readings: Vec<Reading>,
    /// One for each interval, in order.
    pub points: Vec<Filter>,
    /// That of the time after the end, where it is held.
    pub held: Option<Filter>,
    /// State at the end of the motion as a deviation from the goal that is held behind it, and not quite reached; empty for none.
    pub jump: Vec<f64>,
    /// Constant disturbances that it finds.
    pub lasting: Option<Lasting>,
}

impl Observer {
    /// The filter of an interval; the last one where the end is not held.
    pub(super) fn at(&self, interval: usize) -> &Filter {
        let last = self.held.as_ref().or(self.points.last());
        let own = self.points.get(interval).or(last);
        own.expect("an observer has an interval")
    }
}

/// Sweeps over all inputs.
const SWEEPS: usize = 50;
/// Cost of an input relative to that of its forces: of inputs that do the same the smallest are found.
const SMALL: f64 = 1e-9;

/// A coordinate on which a constant disturbance acts.
#[derive(Clone, Debug, PartialEq)]
pub struct Forced {
    /// Its name.
    pub name: String,
    /// True for a force in N, false for a torque in N mm.
    pub is_length: bool,
}

/// Constant disturbances that an observer finds beside the state.
#[derive(Clone, Debug, PartialEq)]
pub struct Lasting {
    /// Coordinates on which they act.
    pub on: Vec<Forced>,
    /// F, by force over the inputs, or their squares.
    pub by_inputs: DMatrix<f64>,
}

impl Lasting {
    /// Improves the changes of inputs at the held goal, within `limits`, that are `against` forces; `left` has room for one number a force.
    pub(super) fn hold(
        &self,
        forces: &[f64],
        limits: &[[f64; 2]],
        against: &mut [f64],
        left: &mut [f64],
    ) {
        for (row, left) in left.iter_mut().enumerate() {
            *left = forces[row] + product(&self.by_inputs, row, against);
        }
        for _ in 0..SWEEPS {
            for (i, u) in against.iter_mut().enumerate() {
                let of = self.by_inputs.column(i);
                let size = of.norm_squared() * (1.0 + SMALL);
                if size == 0.0 {
                    continue;
                }
                let slope: f64 = of.iter().zip(&*left).map(|(f, left)| f * left).sum();
                let slope = slope + SMALL * of.norm_squared() * *u;
                let [low, high] = limits[i];
                let change = (*u - slope / size).clamp(low, high) - *u;
                *u += change;
                let changed = left.iter_mut().zip(&of);
                changed.for_each(|(left, f)| *left += f * change);
            }
        }
    }
}
