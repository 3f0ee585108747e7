//! Resolution of a motion by a step: the turns of joints and bodies, and the balance of energy.
//!
//! The midpoint rule reads forces at the middle of a step. What a joint or body does beyond that is seen at the ends alone:
//! a free turn by θ is found from sin θ = h ω, which has other roots beyond a right angle, and a joint angle is the same
//! after whole turns. Over a step the potential energy V changes by V(x₁) − V(x₀), while the forces at the middle do the work
//! −∇V(x̄)·(x₁ − x₀). Their sum is the energy that the step makes or loses, of third order in the step and exactly zero where V
//! is quadratic, however fast the oscillation. Voltages are constant within a step and supply nothing there; dissipation
//! takes as much as it does work. A Galerkin method of degree s sums the work of the forces by its quadrature, along its polynomial and, where
//! inputs change within the step, along the polynomial through them: the error is of order 2s + 1, and zero where V is quadratic too.
//!
//! Local errors of the steps of a motion, estimated from the motion itself.
//!
//! A method of order p neglects in a step of h the term c hᵖ⁺¹ x⁽ᵖ⁺¹⁾ of the motion x of a point; for p = 2s the constant is
//! that of the diagonal Padé approximation of the exponential, c = (s!)²/((2s)! (2s + 1)!), 1/12 for the midpoint rule, and 1/2
//! for implicit Euler. The derivative is a divided difference of p + 2 recorded instants: those around the step, next to
//! switches of the voltages where there is room.
//!
//! The sum over all steps is an estimate of how far the motion ends from the exact one where errors neither grow nor decay.
//! Damping makes them less, an unstable motion more than that.

use crate::coordinates::Configuration;
use crate::dynamics::energies::Work;
use crate::dynamics::error::StepError;
use crate::dynamics::trajectory::{DiscreteTrajectory, Trajectory};
use crate::functional::{Sample, TermKind};
use crate::math::Vector;
use crate::model::{ContactReading, Model};
use std::f64::consts::PI;

/// Part of the energy exchanged in a step that may be made or lost in it.
const PART: f64 = 0.25;
/// Relative size of energies that is rounding.
const ROUNDING: f64 = 1e-9;

/// The energy of one step of the midpoint rule or a Galerkin method, in mJ.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Balance {
    /// Energy that is made (or lost, where negative).
    made: f64,
    /// Energy in motion: kinetic at the middle, change of the potential, dissipation.
    exchanged: f64,
    /// Work of forces without a potential.
    work: Work,
    /// Size of the energies that were subtracted from each other, those of single elements included.
    size: f64,
}

/// A point of the quadrature over a step: its weight, what the terms read there and the forces on the vectors at both ends.
pub(super) type Part<'a> = (f64, Sample<'a>, &'a [Vec<Vector>; 2]);

impl Balance {
    /// Of a step from one end to the other, whose equations are a sum over some parts; `typical` is the energy of [`typical_energy`], `supplied`
    /// what inputs that change within the step add to the potential energy.
    pub(super) fn new<'a>(
        model: &Model,
        typical: f64,
        supplied: f64,
        ends: [Sample<'_>; 2],
        parts: impl Iterator<Item = Part<'a>>,
    ) -> Self {
        let terms = &model.action.intervals.terms;
        let (mut change, mut size) = (-supplied, 0.0_f64);
        for term in terms.iter().filter(|t| t.kind() == TermKind::Potential) {
            let [before, after] = ends.map(|end| term.energy(&end));
            change += after - before;
            size += before.abs() + after.abs();
        }
        let (mut kinetic, mut of_forces) = (0.0, 0.0);
        let mut work = Work::default();
        for (weight, sample, [a, b]) in parts {
            for term in terms {
                work.add(weight, term.as_ref(), &sample);
                if term.kind() == TermKind::Kinetic {
                    kinetic += weight * term.energy(&sample);
                }
            }
            let [start, end] = sample.vectors;
            let ways = start.iter().zip(end).map(|(x, y)| y - x);
            let done = ways
                .zip(a.iter().zip(b))
                .map(|(displacement, (a, b))| displacement.dot(&(a + b)));
            // The forces of an interval carry its length, those without a potential included.
            of_forces += weight * done.sum::<f64>() / sample.h;
        }
        let lost = of_forces - (work.applied + work.dissipation);
        Self {
            made: change + lost,
            exchanged: kinetic + change.abs() + work.applied.abs() + work.dissipation.abs(),
            size: typical + size + kinetic,
            work,
        }
    }

    /// Work of forces without a potential over the step.
    pub(super) fn work(&self) -> Work {
        self.work
    }

    /// Energy that the step makes, or loses where negative.
    pub(super) fn made(&self) -> f64 {
        self.made
    }

    /// Energy in motion during the step, at least what is rounding: at rest no other moves.
    pub(super) fn exchanged(&self) -> f64 {
        self.exchanged.max(ROUNDING * self.size)
    }

    /// Returns the reason why a step of `step` ms is not accepted: an element is crushed at its end, or the balance does not close. Forces that
    /// do not exist are not judged.
    pub(super) fn refusal(&self, model: &Model, time: f64, step: f64) -> Option<StepError> {
        let &Self {
            made, exchanged, ..
        } = self;
        if !self.size.is_finite() && !model.solids.is_empty() {
            return Some(StepError::Inverted { time, step });
        }
        let allowed = (PART * exchanged).max(ROUNDING * self.size);
        (made.abs() > allowed).then_some(StepError::Unbalanced {
            time,
            step,
            made,
            exchanged,
        })
    }
}

/// Energy in mJ that stretches all muscles and blocks of a system to some multiple of their size: the sum of shear modulus times
/// volume.
pub(super) fn typical_energy(model: &Model) -> f64 {
    let muscles = model.system.muscles.iter().map(|muscle| {
        let [width, depth] = muscle.cross_section;
        muscle.material.shear_modulus * width * depth * muscle.length()
    });
    let solids = model.system.solids.iter().map(|solid| {
        let (low, high) = solid.mesh.bounds();
        let moduli = solid.materials.iter().map(|m| m.shear_modulus);
        (high - low).product() * moduli.fold(0.0, f64::max)
    });
    let components = model.system.components.iter();
    let components = components.map(|component| component.typical_energy());
    muscles.chain(solids).chain(components).sum()
}

/// The first joint that a step turns by more than half a turn, or body that it turns by more than a right angle in space,
/// between two placed instants; with the angle in rad.
pub(super) fn turned(
    model: &Model,
    start: &Configuration,
    end: &Configuration,
) -> Option<(String, f64)> {
    let map = &model.action.map;
    let of_joints = map.tree.coordinates();
    let turns = |&i: &usize| {
        let turn = (end.z[i] - start.z[i]).abs();
        (turn > PI || turn.is_nan()) && !model.is_length(i)
    };
    if let Some(i) = (0..of_joints).find(turns) {
        return Some((
            model.variables.unknown(i).to_string(),
            (end.z[i] - start.z[i]).abs(),
        ));
    }
    let bodies = &model.presolved.system.bodies;
    bodies.iter().enumerate().find_map(|(body, named)| {
        let [before, after] = [start, end].map(|at| map.directors(at, body));
        // 1 + 2 cos θ of the rotation from one to the other.
        let trace = before.dot(&after);
        let angle = (0.5 * (trace - 1.0)).clamp(-1.0, 1.0).acos();
        (trace < 1.0).then(|| (format!("body \"{}\"", named.name), angle))
    })
}

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

/// Estimates the error of a motion, whose poses and markers are known, by a method of an order; nothing where it has fewer than order + 1
/// steps.
pub fn local_error(
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

/// Steps of a touch from which on its rebound is resolved.
pub const STEPS_OF_TOUCH: usize = 4;

/// The shortest touch of a contact, of fewer steps than resolve it.
#[derive(Clone, Debug, PartialEq)]
pub struct ShortTouch {
    /// Name of the contact.
    pub name: String,
    /// Time in ms at which it begins.
    pub time: f64,
    /// Length of the touch in ms.
    pub duration: f64,
    /// Its steps.
    pub steps: usize,
}

/// Touches in the middles of steps that begin and end within a motion, the shortest of each contact where it is not resolved.
pub fn short_touches(model: &Model, discrete: &DiscreteTrajectory) -> Vec<ShortTouch> {
    let contacts = &model.contacts;
    let mut shortest: Vec<Option<ShortTouch>> = vec![None; contacts.len()];
    if contacts.is_empty() || discrete.z.is_empty() {
        return Vec::new();
    }
    let mut begun: Vec<Option<usize>> = vec![None; contacts.len()];
    let [mut here, mut next] = [(), ()].map(|()| model.action.map.instant());
    here.z.copy_from_slice(&discrete.z[0]);
    model.action.map.vectors(&mut here);
    for k in 0..discrete.intervals() {
        next.z.copy_from_slice(&discrete.z[k + 1]);
        model.action.map.vectors(&mut next);
        let middles: Vec<Vector> = here
            .x
            .iter()
            .zip(&next.x)
            .map(|(a, b)| (a + b) * 0.5)
            .collect();
        for (c, contact) in contacts.iter().enumerate() {
            // At rest: the overlap alone counts.
            let touches = contact.touch([&middles, &middles]).overlap > 0.0;
            match begun[c] {
                None if touches => begun[c] = Some(k),
                Some(first) if !touches => {
                    begun[c] = None;
                    let steps = k - first;
                    let least = shortest[c].as_ref().map_or(STEPS_OF_TOUCH, |one| one.steps);
                    if first > 0 && steps < least {
                        shortest[c] = Some(ShortTouch {
                            name: contact.name.clone(),
                            time: discrete.times[first],
                            duration: discrete.times[k] - discrete.times[first],
                            steps,
                        });
                    }
                }
                _ => {}
            }
        }
        std::mem::swap(&mut here, &mut next);
    }
    shortest.into_iter().flatten().collect()
}

/// Distance from the first touch at which a step ends there, in lengths of the system.
const AT_TOUCH: f64 = 1e-6;

/// The part of a step after which the first of the contacts that begin or end in it does so, by their overlaps at both ends.
pub(super) fn part_to_touch(model: &Model, ends: [&Configuration; 2]) -> Option<f64> {
    let near = AT_TOUCH * model.length();
    let part = |contact: &ContactReading| {
        let ramp = 0.5 * contact.law.smoothing;
        let [a, b] = ends.map(|end| contact.touch([&end.x, &end.w]).overlap + ramp);
        let changes = a * b < 0.0 && a.abs().min(b.abs()) > near;
        changes.then(|| a / (a - b))
    };
    let parts = model.contacts.iter().filter_map(part);
    parts.min_by(f64::total_cmp)
}

/// The least gap in mm of each contact at the instants of a motion, by the names of contacts; negative where both sides overlap.
pub fn least_gaps<'m>(model: &'m Model, discrete: &DiscreteTrajectory) -> Vec<(&'m str, f64)> {
    let mut here = model.action.map.instant();
    let mut gaps = vec![f64::INFINITY; model.contacts.len()];
    for z in &discrete.z {
        here.z.copy_from_slice(z);
        model.action.map.vectors(&mut here);
        for (gap, contact) in gaps.iter_mut().zip(&model.contacts) {
            *gap = gap.min(-contact.touch([&here.x, &here.x]).overlap);
        }
    }
    let names = model.contacts.iter().map(|one| one.name.as_str());
    names.zip(gaps).collect()
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
