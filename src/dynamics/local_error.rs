//! Local errors of the steps of a motion, estimated from the motion itself.
//!
//! A method of order p neglects in a step of h the term c hᵖ⁺¹ x⁽ᵖ⁺¹⁾ of the motion x of a point; for p = 2s the constant is
//! that of the diagonal Padé approximation of the exponential, c = (s!)²/((2s)! (2s + 1)!), 1/12 for the midpoint rule, and 1/2
//! for implicit Euler. The derivative is a divided difference of p + 2 recorded instants: those around the step, next to
//! switches of the voltages where there is room.
//!
//! The sum over all steps is an estimate of how far the motion ends from the exact one where errors neither grow nor decay.
//! Damping makes them less, an unstable motion more than that.

use crate::dynamics::trajectory::{DiscreteTrajectory, Trajectory};
use crate::math::Vector;
use crate::model::Model;

/// Part of the length of the system below which a path is none: states of rest are found no nearer.
const NO_PATH: f64 = 1e-8;

/// The estimate for a motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LocalError {
    /// Sum of the local errors, of the point where it is greatest, in mm; zero of a robot at rest.
    pub error: f64,
    /// Way of the point that goes farthest, in mm.
    pub path: f64,
    /// Order of the method.
    pub order: usize,
    /// True if differences of the motion fall with their order, so that the estimate is meaningful.
    pub is_resolved: bool,
    /// Mean step in ms.
    pub step: f64,
}

impl LocalError {
    /// Error as a part of the path; zero where nothing moves.
    pub fn relative(&self) -> f64 {
        match self.error > 0.0 {
            true => self.error / self.path,
            false => 0.0,
        }
    }

    /// Step in ms that would leave the part `relative` of the path, two digits rounded down; a tenth of the step where that
    /// does not resolve the motion.
    pub fn step_for(&self, relative: f64) -> f64 {
        let step = match self.is_resolved {
            true => self.step * (relative / self.relative()).powf(1.0 / self.order as f64),
            false => 0.1 * self.step,
        };
        let digits = 10_f64.powf(1.0 - step.log10().floor());
        (step * digits).floor() / digits
    }
}

/// Estimates the error of a motion by a method of an order; nothing where it has fewer than order + 1 steps.
pub fn local_error(
    model: &Model,
    discrete: &DiscreteTrajectory,
    order: usize,
) -> Option<LocalError> {
    let motion = Trajectory::from_discrete(model, discrete);
    local_error_of(model, discrete, &motion, order)
}

/// The same of a motion whose poses and markers are known.
pub fn local_error_of(
    model: &Model,
    discrete: &DiscreteTrajectory,
    motion: &Trajectory,
    order: usize,
) -> Option<LocalError> {
    let (steps, window) = (discrete.intervals(), order + 1);
    if steps < window {
        return None;
    }
    let places = places(model, discrete, motion);
    let points = places[0].len();
    let constant = constant(order);
    let switches = switches(model, discrete);
    // By point: what is neglected, the distance, and the sums of the differences of the two highest orders.
    let mut sums = vec![[0.0; 4]; points];
    for k in 0..steps {
        let h = discrete.times[k + 1] - discrete.times[k];
        let first = k.saturating_sub(order)..=k.min(steps - window);
        let centred = |j: &usize| (2 * j + window).abs_diff(2 * k + 1);
        let crossed = |j: &usize| switches[j + order] - switches[*j];
        let j = first.min_by_key(|j| (crossed(j), centred(j))).unwrap_or(0);
        let times = &discrete.times[j..=j + window];
        let [high, low] = [times, &times[..window]].map(|t| weights(t, h));
        for (point, sum) in sums.iter_mut().enumerate() {
            let difference = |weights: &[f64]| {
                // The weights sum to zero: what rests leaves no rounding.
                let first = places[j][point];
                let terms = weights.iter().zip(&places[j..]);
                let sum: Vector = terms.map(|(w, at)| (at[point] - first) * *w).sum();
                sum.norm()
            };
            let (highest, before) = (difference(&high), difference(&low));
            let distance = (places[k + 1][point] - places[k][point]).norm();
            sum[0] += constant * highest;
            sum[1] += distance;
            sum[2] += highest;
            sum[3] += before;
        }
    }
    let worst = sums.iter().copied().max_by(|a, b| a[0].total_cmp(&b[0]))?;
    let path = sums.iter().map(|sum| sum[1]).fold(0.0, f64::max);
    let moves = path > NO_PATH * model.length();
    Some(LocalError {
        error: if moves { worst[0] } else { 0.0 },
        path,
        order,
        is_resolved: worst[2] <= worst[3],
        step: (discrete.times[steps] - discrete.times[0]) / steps as f64,
    })
}

/// Greatest distance in mm between points of a motion at some instants and those of another motion at all of its instants.
pub fn distance_between(
    model: &Model,
    motion: (&DiscreteTrajectory, &Trajectory),
    instants: &[usize],
    other: (&DiscreteTrajectory, &Trajectory),
) -> f64 {
    let [here, there] = [motion, other].map(|(discrete, motion)| places(model, discrete, motion));
    let pairs = instants.iter().map(|&k| &here[k]).zip(&there);
    let points = pairs.flat_map(|(here, there)| here.iter().zip(there));
    points
        .map(|(here, there)| (here - there).norm())
        .fold(0.0, f64::max)
}

/// The constant of the neglected term.
fn constant(order: usize) -> f64 {
    let factorial = |n: usize| (1..=n).map(|i| i as f64).product::<f64>();
    match order {
        1 => 0.5,
        _ => factorial(order / 2).powi(2) / (factorial(order) * factorial(order + 1)),
    }
}

/// Weights of the values at some times in hⁿ x⁽ⁿ⁾, n one less than their number: n! hⁿ times those of the divided difference.
fn weights(times: &[f64], h: f64) -> Vec<f64> {
    let others = |i: usize| (0..times.len()).filter(move |&j| j != i);
    let factors = |i: usize| {
        let product = others(i)
            .zip(1..)
            .map(|(j, m)| f64::from(m) * h / (times[i] - times[j]));
        product.product::<f64>()
    };
    (0..times.len()).map(factors).collect()
}

/// Returns the number of switches of voltages up to each instant.
fn switches(model: &Model, discrete: &DiscreteTrajectory) -> Vec<usize> {
    let voltages = |k: usize| model.variables.split(&discrete.scalars[k])[0];
    let mut count = 0;
    let mut counts = vec![0];
    for k in 1..discrete.intervals() {
        count += usize::from(voltages(k) != voltages(k - 1));
        counts.push(count);
    }
    counts.push(count);
    counts
}

/// Points that show a motion, by instant, in mm: markers; of each body the centre and the ends of its directors at the radius
/// of gyration; nodes.
fn places(model: &Model, discrete: &DiscreteTrajectory, motion: &Trajectory) -> Vec<Vec<Vector>> {
    let nodes = &model.action.map.of_nodes;
    let first = model.action.map.of_bodies;
    let radius: Vec<f64> = model
        .system
        .bodies
        .iter()
        .map(|body| (0.5 * body.inertia.iter().sum::<f64>() / body.mass).sqrt())
        .map(|radius| if radius.is_finite() { radius } else { 0.0 })
        .collect();
    let at = |k: usize| {
        let mut places = motion.marks[k].clone();
        for (pose, radius) in motion.poses[k].iter().zip(&radius) {
            places.push(pose.centre);
            let ends = pose.directors.column_iter();
            places.extend(ends.map(|d| pose.centre + d * *radius));
        }
        let bodies = places.len();
        for (&(node, axis), value) in nodes.iter().zip(&discrete.z[k][first..]) {
            places.resize((bodies + node + 1).max(places.len()), Vector::zeros());
            places[bodies + node][axis] = *value;
        }
        places
    };
    (0..discrete.z.len()).map(at).collect()
}
