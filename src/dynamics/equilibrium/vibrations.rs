//! Small vibrations about a state of rest: natural frequencies, damping ratios and shapes, exact for any damping.
//!
//! The rows of an interval with both instants at the state of rest have the second derivatives
//!
//! ```text
//! B₀₀ =  M/h − h K/4 + C/2        B₀₁ = −M/h − h K/4 − C/2
//! B₁₀ = −M/h − h K/4 + C/2        B₁₁ =  M/h − h K/4 − C/2
//! ```
//!
//! beside the curvature of the coordinates, which belongs to K alone. They give M and C, rest gives K with multipliers and potentials, and
//!
//! ```text
//! M q̈ + C q̇ + K q = 0,    q = v exp(λ t):    (λ² M + λ C + K) v = 0.
//! ```
//!
//! With w = λ v the map (v, w) → (−K⁻¹ (C v + M w), v) has the eigenvalues 1/λ: its largest ones belong to the slowest motions. What remembers has no
//! inertia, so that relaxations are among them, and λ = ∞ of constraints is none.

use crate::dynamics::equilibrium::krylov::{self, Pair};
use crate::dynamics::equilibrium::rest_state::{Equilibrium, RestState};
use crate::dynamics::equilibrium::softest_mode::moves;
use crate::dynamics::equilibrium::statics::Statics;
use crate::functional::{Order, Sample};
use crate::math::Vector;
use crate::model::Model;
use crate::stop;
use nalgebra::{Complex, DVector};

/// Dimensions of the space beside those for each vibration.
const DIMENSIONS: usize = 120;
/// Dimensions for each vibration that is asked for.
const FOR_EACH: usize = 12;
/// Imaginary part of an eigenvalue, relative to its size, from which on a motion vibrates: with less two that decay alike may be meant.
const VIBRATES: f64 = 1e-3;
/// Residuals of eigenvalues that are told, and of those that are exact.
const ROUGH: f64 = 1e-4;
const EXACT: f64 = 1e-8;

/// Newton's update at a state of rest, in rad and lengths of the system.
const AT_REST: f64 = 1e-7;
/// Parts of a sum below which it is rounding.
const LOST: f64 = 1e-13;

/// Entries of a matrix over coordinates.
type Entries = Vec<((usize, usize), f64)>;

/// A model about a state of rest.
#[derive(Debug)]
pub struct Vibrations<'m> {
    pub(super) statics: Statics<'m>,
    state: RestState,
    pub(super) damping: Entries,
    pub(super) mass: Entries,
    /// Sizes of the coordinates.
    scales: Vec<f64>,
}

/// A vibration q = Re v exp(λ t).
#[derive(Clone, Debug)]
pub struct Vibration {
    /// Natural frequency |λ|/2π in kHz.
    pub frequency: f64,
    /// Damping ratio −Re λ/|λ|.
    pub damping: f64,
    /// Real and imaginary part of the change of each coordinate; the largest is 1 (rad, or lengths of the system) and real.
    pub shape: [Vec<f64>; 2],
    /// Parts that move most, in words.
    pub moves: String,
}

impl Vibration {
    /// Frequency |Im λ|/2π in kHz at which it swings.
    pub fn damped_frequency(&self) -> f64 {
        self.frequency * (1.0 - self.damping * self.damping).max(0.0).sqrt()
    }
}

/// The slowest motions about a state of rest.
#[derive(Clone, Debug)]
pub struct Modes {
    /// Vibrations by their frequencies.
    pub vibrations: Vec<Vibration>,
    /// Rate in 1/ms of the slowest motion without vibration, which decays or, where it is negative, grows; none where there is none.
    pub slowest_decay: Option<f64>,
    /// True if they fulfil their equations but for rounding.
    pub are_exact: bool,
}

impl<'m> Vibrations<'m> {
    /// Linearises a model about a state of rest; `None` where the stiffness is singular, or the state is not at rest or one of another model.
    pub fn about(model: &'m Model, rest: &Equilibrium) -> Option<Self> {
        let map = &model.action.map;
        let sizes = [map.instant().z.len(), model.action.intervals.scalars];
        if [rest.z.len(), rest.scalars.len()] != sizes {
            return None;
        }
        let [inputs, others] = model.variables.split(&rest.scalars);
        let mut statics = Statics::new(model, inputs);
        let state = statics.state(&rest.z, others);
        statics.evaluate(&state, inputs);
        statics.factor().ok()?;
        let mut update = statics.residual.clone();
        statics.solve(&mut update);
        if statics.size(&update[..statics.scales().len()]) > AT_REST
            || update.iter().any(|part| part.is_nan())
        {
            return None;
        }
        let [damping, mass] = rates(model, &statics.configuration(&state), &rest.scalars);
        let sizes = statics.scales().iter();
        let scales = sizes.map(|size| if size.is_finite() { *size } else { 1.0 });
        Some(Self {
            scales: scales.collect(),
            statics,
            state,
            damping,
            mass,
        })
    }

    /// Coordinates with charts of the state.
    pub(super) fn place(&self) -> Vec<f64> {
        self.statics.configuration(&self.state)
    }

    /// The slowest motions, up to `count` vibrations; `None` where they are not found or it was stopped.
    pub fn modes(&mut self, count: usize) -> Option<Modes> {
        let n = self.scales.len();
        let time = self.time()?;
        let most = DIMENSIONS + FOR_EACH * count;
        let is_vibration = |value: &Complex<f64>| value.im < -VIBRATES * value.norm();
        let is_single = |value: &Complex<f64>| value.im.abs() <= VIBRATES * value.norm();
        let choose = |values: &[Complex<f64>]| {
            let all = || 0..values.len();
            let vibrations = all().filter(|&k| is_vibration(&values[k])).take(count);
            let mut wanted: Vec<usize> = vibrations.collect();
            let is_enough = wanted.len() == count;
            wanted.extend(all().find(|&k| is_single(&values[k])));
            krylov::Choice { wanted, is_enough }
        };
        let map = |vector: &DVector<f64>| self.map(vector, time);
        let mut pairs = krylov::largest(2 * n, most, map, choose)?;
        pairs.retain(|pair| pair.residual <= ROUGH);
        let exact = pairs.iter().all(|pair| pair.residual <= EXACT);
        let (vibrations, others): (Vec<Pair>, Vec<Pair>) = pairs
            .into_iter()
            .partition(|pair| is_vibration(&pair.value));
        let slowest = others.first();
        Some(Modes {
            slowest_decay: slowest.map(|pair| -1.0 / (time * pair.value.re)),
            vibrations: vibrations
                .iter()
                .map(|pair| self.vibration(pair, time))
                .collect(),
            are_exact: exact,
        })
    }

    /// The coordinates with charts of a vibration at a phase, whose largest change has a size in rad and lengths of the system.
    pub fn deflected(&self, one: &Vibration, phase: f64, size: f64) -> Vec<f64> {
        let (sin, cos) = phase.sin_cos();
        let [real, imaginary] = &one.shape;
        let parts = real.iter().zip(imaginary);
        let change: Vec<f64> = parts.map(|(re, im)| re * cos - im * sin).collect();
        self.statics
            .configuration(&self.statics.moved(&self.state, size, &change))
    }

    /// A time in ms of the order of the slowest motion.
    fn time(&mut self) -> Option<f64> {
        let n = self.scales.len();
        let mut vector = DVector::from_element(2 * n, 1.0);
        let mut time: f64 = 1.0;
        for _ in 0..4 {
            let next = self.map(&vector, 1.0)?;
            let slow = next.norm() / vector.norm();
            time = slow;
            vector = next / slow.max(f64::MIN_POSITIVE);
        }
        (time.is_finite() && time > 0.0).then_some(time)
    }

    /// The map of (v, T w) by the sizes of the coordinates, over a time T.
    fn map(&mut self, vector: &DVector<f64>, time: f64) -> Option<DVector<f64>> {
        if stop::reason().is_some() {
            return None;
        }
        let n = self.scales.len();
        let at = |i: usize| vector[i] * self.scales[i % n];
        // The tangent is −h K.
        let h = self.statics.model.multiplier_time;
        let mut rows = vec![0.0; self.statics.residual.len()];
        for &((i, j), value) in &self.damping {
            rows[i] += h * value * at(j) / time;
        }
        for &((i, j), value) in &self.mass {
            rows[i] += h * value * at(n + j) / (time * time);
        }
        self.statics.solve(&mut rows);
        let next = DVector::from_fn(2 * n, |i, _| match i < n {
            true => rows[i] / self.scales[i],
            false => vector[i - n],
        });
        next.iter().all(|value| value.is_finite()).then_some(next)
    }

    fn vibration(&self, pair: &Pair, time: f64) -> Vibration {
        let n = self.scales.len();
        let parts = pair.vector.rows(0, n);
        let largest = parts.iter().max_by(|a, b| a.norm().total_cmp(&b.norm()));
        let largest = *largest.expect("a coordinate");
        let shape = parts
            .iter()
            .zip(&self.scales)
            .map(|(part, scale)| part / largest * *scale);
        let shape: Vec<Complex<f64>> = shape.collect();
        let part = |of: fn(&Complex<f64>) -> f64| shape.iter().map(of).collect::<Vec<f64>>();
        let shape = [part(|c| c.re), part(|c| c.im)];
        let lambda = (pair.value * time).inv();
        Vibration {
            frequency: lambda.norm() / std::f64::consts::TAU,
            damping: -lambda.re / lambda.norm(),
            moves: moves(self.statics.model, &self.place(), &shape[0]),
            shape,
        }
    }
}

/// Entries of C and of M at a state of rest.
fn rates(model: &Model, z: &[f64], scalars: &[f64]) -> [Entries; 2] {
    let action = &model.action;
    let (layout, h) = (action.layout(), model.multiplier_time);
    let mut ends = [action.map.placed(z), action.map.placed(z)];
    let mut scratch = action.scratch(Order::Hessian);
    let mut values = vec![0.0; layout.values(1)];
    let interval = Sample::of_interval(scalars, h);
    let [here, next] = &mut ends;
    for end in [&mut *here, &mut *next] {
        end.forces.fill(Vector::zeros());
    }
    action.evaluate_interval(Order::Hessian, [here, next], &interval, &mut scratch);
    action.pull_back_interval(
        Order::Hessian,
        [here, next],
        &interval,
        0,
        &mut scratch,
        &mut values,
    );
    let at = |firsts: [usize; 2], slot: usize| firsts.map(|first| values[first + slot]);
    let mut entries: Vec<[f64; 3]> = (0..layout.same.entries().len())
        .map(|slot| {
            let [a, b] = at([layout.same_at(0), layout.same_at(1)], slot);
            [a - b, a + b, a.abs() + b.abs()]
        })
        .collect();
    for (slot, (row, col)) in layout.cross.entries().enumerate() {
        let [upper, lower] = at([layout.upper_at(0), layout.lower_at(0)], slot);
        let same = layout.same.find(row, col);
        let same = same.expect("what couples neighbouring instants couples within one");
        let added = [lower - upper, -upper - lower, upper.abs() + lower.abs()];
        let sums = entries[same].iter_mut().zip(added);
        sums.for_each(|(sum, value)| *sum += value);
    }
    let is_free = |i: usize| i < action.map.coordinates && !model.is_prescribed(i);
    let (mut damping, mut mass) = (Entries::new(), Entries::new());
    for ((row, col), [of_damping, of_mass, size]) in layout.same.entries().zip(entries) {
        if !is_free(row) || !is_free(col) {
            continue;
        }
        // What is left of larger numbers is rounding.
        if of_damping.abs() > LOST * size {
            damping.push(((row, col), 0.5 * of_damping));
        }
        if of_mass.abs() > LOST * size {
            mass.push(((row, col), 0.25 * h * of_mass));
        }
    }
    [damping, mass]
}
