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

use nalgebra::DMatrix;

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
            let known = state.iter().enumerate();
            let known = known.map(|(i, x)| self.output[(row, i)] * x).sum::<f64>();
            let found = readings[row] - self.readings[row] - known;
            *error = if found.is_finite() { found } else { 0.0 };
        }
        for (i, x) in state.iter_mut().enumerate() {
            let terms = errors.iter().enumerate();
            *x += terms
                .map(|(row, error)| self.gain[(i, row)] * error)
                .sum::<f64>();
        }
    }

    /// The state of the next interval.
    pub(super) fn predict(&self, state: &[f64], inputs: &[f64], next: &mut [f64]) {
        for (i, next) in next.iter_mut().enumerate() {
            let by_state = state.iter().enumerate();
            let by_inputs = inputs.iter().enumerate();
            *next = by_state
                .map(|(j, x)| self.by_state[(i, j)] * x)
                .sum::<f64>()
                + by_inputs
                    .map(|(j, u)| self.by_inputs[(i, j)] * u)
                    .sum::<f64>();
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
    /// Number of constant disturbances.
    pub fn forces(&self) -> usize {
        self.lasting.as_ref().map_or(0, |lasting| lasting.on.len())
    }

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
            let held = against.iter().enumerate();
            *left = forces[row] + held.map(|(i, u)| self.by_inputs[(row, i)] * u).sum::<f64>();
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
