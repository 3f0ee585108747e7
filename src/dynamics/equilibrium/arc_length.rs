//! Loads that grow along a path of equilibria, first the weights with the forces of the scene, then the voltages; and equilibria along such a path
//! by arc length, past limit points, where the load falls again.
//!
//! With the rows R(y, f) of a state y under the fraction f of a load, K = ∂R/∂y and b = ∂R/∂f, the tangent of the
//! path is K ẏ = −ḟ b. A step follows it by Δs and comes back to the path in the plane normal to it. The path has a
//! limit point (pull-in) where ḟ = 0; where a pivot of K changes its sign elsewhere, it meets another path (buckling).

use crate::dynamics::equilibrium::rest_state::{Instability, Load, RestState};
use crate::dynamics::equilibrium::statics::{NewtonOutcome, Statics, UpdateRange};
use crate::dynamics::singular_configurations::shortest;
use crate::model::Role;
use crate::stop;

/// Limit of corrections in one step.
const CORRECTIONS: usize = 12;
/// Convergence of a correction, relative to angles of one radian and the length of the system.
const UPDATE: f64 = 1e-11;
/// Corrections below this that no longer fall are rounding.
const ROUNDING: f64 = 1e-8;
/// Least cosine of the angle between the tangents at both ends of a step.
pub(super) const STRAIGHT: f64 = 0.9;
/// Steps below this may turn by any angle: a path has kinks where tendons tighten and stops are met.
pub(super) const KINK: f64 = 1e-3;
/// First step along the path, in units of the fraction and of strains.
pub(super) const FIRST: f64 = 0.02;
/// Largest step.
pub(super) const LARGEST: f64 = 0.1;
/// Steps below this end the path.
pub(super) const SMALLEST: f64 = 1e-7;
/// Limit of steps in the search of a limit point.
const STEPS: usize = 200;
/// Largest number of halvings of the step over a branching point.
const HALVINGS: usize = 24;
/// Slope ḟ that counts as zero; the fraction is then exact to its square.
const FLAT: f64 = 1e-6;

/// Least stretch of a muscle on a path: below it the path ends.
const SHORTEST: f64 = 0.05;

/// A load that grows, and the voltages when all of it acts.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ramp<'v> {
    pub(super) load: Load,
    pub(super) voltages: &'v [f64],
}

impl Ramp<'_> {
    /// Lets a fraction of the weights act; returns the voltages of a fraction.
    pub(super) fn apply(&self, statics: &mut Statics<'_>, fraction: f64) -> Vec<f64> {
        let (weight, part) = match self.load {
            Load::Forces => (fraction, 0.0),
            Load::Voltages => (1.0, fraction),
        };
        statics.weight = weight;
        let variables = &statics.model.variables;
        let scaled = |(value, role)| {
            if role == Role::Voltage {
                value * part
            } else {
                value
            }
        };
        variables.with_roles(self.voltages).map(scaled).collect()
    }

    /// Adds the derivative of the rows by the fraction, at the state evaluated last.
    pub(super) fn add(&self, statics: &Statics<'_>, rows: &mut [f64]) {
        match self.load {
            Load::Forces => statics.add_weight(rows),
            Load::Voltages => {
                let variables = &statics.model.variables;
                let change = variables.inputs_where(self.voltages, |role| role == Role::Voltage);
                statics.add_load(&change, rows);
            }
        }
    }

    /// Derivative of the fraction by the part of the way at a fraction.
    pub(super) fn slope(&self, fraction: f64) -> f64 {
        match self.load {
            Load::Forces => 1.0,
            Load::Voltages => 0.5 / fraction,
        }
    }

    /// Derivative of the state by the fraction, −K⁻¹ b, at the state evaluated and factorised last.
    pub(super) fn response(&self, statics: &mut Statics<'_>) -> Vec<f64> {
        let mut load = vec![0.0; statics.residual.len()];
        self.add(statics, &mut load);
        statics.solve(&mut load);
        load.iter_mut().for_each(|v| *v = -*v);
        load
    }

    /// The fraction at a part of the way that a path takes: forces of voltages grow with their squares.
    pub(super) fn fraction(&self, part: f64) -> f64 {
        match self.load {
            Load::Forces => part,
            Load::Voltages => part.sqrt(),
        }
    }
}

/// End of a path of stable states.
pub(super) enum PathEnd {
    /// All of the load acts.
    Reached(RestState),
    /// The point at which it is lost.
    Lost(PathPoint, Instability),
}

/// A point of the path.
#[derive(Clone, Debug)]
pub(super) struct PathPoint {
    pub(super) state: RestState,
    pub(super) fraction: f64,
    /// Unit tangent: state, then fraction.
    pub(super) tangent: (Vec<f64>, f64),
    pub(super) unstable: Option<usize>,
}

/// The path from a state of equilibrium on.
pub(super) struct Path<'s, 'm> {
    pub(super) statics: &'s mut Statics<'m>,
    ramp: Ramp<'s>,
    weights: Vec<f64>,
}

impl Path<'_, '_> {
    fn dot(&self, a: &[f64], b: &[f64]) -> f64 {
        let products = a.iter().zip(b).zip(&self.weights);
        products.map(|((a, b), w)| a * b * w).sum()
    }

    /// Evaluates and factorises at a state; returns −K⁻¹ b.
    fn linearise(&mut self, state: &RestState, fraction: f64) -> Option<Vec<f64>> {
        // A path that is to stop ends like one that cannot go on.
        if stop::reason().is_some() {
            return None;
        }
        let voltages = self.ramp.apply(self.statics, fraction);
        self.statics.evaluate(state, &voltages);
        if self.statics.residual.iter().any(|r| !r.is_finite()) {
            return None;
        }
        self.statics.factor().ok()?;
        Some(self.ramp.response(self.statics))
    }

    /// The point at a state of equilibrium; its tangent goes on along `before`, or towards larger fractions.
    pub(super) fn point(
        &mut self,
        state: RestState,
        fraction: f64,
        before: Option<&(Vec<f64>, f64)>,
    ) -> Option<PathPoint> {
        let slope = self.linearise(&state, fraction)?;
        let norm = (1.0 + self.dot(&slope, &slope)).sqrt();
        let along = before.map_or(1.0, |(y, f)| self.dot(&slope, y) + f);
        let ahead = along.signum() / norm;
        let unstable = self.statics.unstable();
        Some(PathPoint {
            tangent: (slope.iter().map(|v| v * ahead).collect(), ahead),
            state,
            fraction,
            unstable,
        })
    }

    /// The point at the arc length `step` from another; `None` where the corrections do not converge, or where the path turns by more than
    /// a step of this length may see.
    pub(super) fn advance(&mut self, from: &PathPoint, step: f64) -> Option<PathPoint> {
        let point = self.within(from, step)?;
        let ((before, ahead), (after, rise)) = (&from.tangent, &point.tangent);
        let is_straight = self.dot(before, after) + ahead * rise > STRAIGHT;
        (is_straight || step < KINK).then_some(point)
    }

    /// The same within a step that was taken, however the path turns.
    fn within(&mut self, from: &PathPoint, step: f64) -> Option<PathPoint> {
        let (direction, ahead) = &from.tangent;
        let mut state = self.statics.moved(&from.state, step, direction);
        let mut fraction = from.fraction + step * ahead;
        let mut last = f64::INFINITY;
        for _ in 0..CORRECTIONS {
            self.statics.iterations += 1;
            let slope = self.linearise(&state, fraction)?;
            let mut update = self.statics.residual.clone();
            self.statics.solve(&mut update);
            update.iter_mut().for_each(|v| *v = -*v);
            let change = -self.dot(direction, &update) / (self.dot(direction, &slope) + ahead);
            for (u, s) in update.iter_mut().zip(&slope) {
                *u += change * s;
            }
            let size = self.statics.size(&update).max(change.abs());
            if size.is_nan() || size > 1.0 {
                return None;
            }
            state = self.statics.moved(&state, 1.0, &update);
            fraction += change;
            // Next to a branching point rounding keeps corrections from falling further.
            if size < UPDATE || (size < ROUNDING && size >= 0.5 * last) {
                return self.point(state, fraction, Some(&from.tangent));
            }
            last = size;
        }
        None
    }

    /// The point between one and another a step later at which stability is lost, and how; none where it is not.
    pub(super) fn lost(
        &mut self,
        before: &PathPoint,
        step: f64,
        after: &PathPoint,
    ) -> Option<(PathPoint, Instability)> {
        if before.tangent.1 > 0.0 && after.tangent.1 <= 0.0 {
            let kind = Instability::of_turn(self.ramp.load);
            return Some((self.turn(before, step, after), kind));
        }
        match (before.unstable, after.unstable) {
            (Some(0), Some(1..)) => Some((self.switch(before, step), Instability::Buckling)),
            _ => None,
        }
    }

    /// The zero of ḟ between a point and the one a step later.
    fn turn(&mut self, before: &PathPoint, step: f64, after: &PathPoint) -> PathPoint {
        let (mut low, mut high) = (0.0, step);
        let (mut at_low, mut at_high) = (before.tangent.1, after.tangent.1);
        let mut best = if at_low.abs() < at_high.abs() {
            before.clone()
        } else {
            after.clone()
        };
        for k in 0..60 {
            let secant = low + (high - low) * at_low / (at_low - at_high);
            let middle = 0.5 * (low + high);
            let trial = if k % 4 == 3 { middle } else { secant };
            let Some(point) = self.within(before, trial) else {
                break;
            };
            let slope = point.tangent.1;
            if slope > 0.0 {
                (low, at_low) = (trial, slope);
            } else {
                (high, at_high) = (trial, slope);
            }
            if slope.abs() < best.tangent.1.abs() {
                best = point;
            }
            if best.tangent.1.abs() < FLAT {
                break;
            }
        }
        best
    }
}

impl Path<'_, '_> {
    /// The state in which all of the load acts next to a point, which is no limit point.
    fn full(&mut self, near: &PathPoint) -> Option<RestState> {
        let mut state = near.state.clone();
        let all = self.ramp.apply(self.statics, 1.0);
        let outcome = self.statics.newton(&mut state, &all, UpdateRange::Near);
        (outcome == Ok(NewtonOutcome::Converged)).then_some(state)
    }

    /// The last stable point between a stable point and the unstable one a step later.
    fn switch(&mut self, before: &PathPoint, step: f64) -> PathPoint {
        let (mut low, mut high) = (0.0, step);
        let mut best = before.clone();
        for _ in 0..HALVINGS {
            let middle = 0.5 * (low + high);
            match self.within(before, middle) {
                Some(point) if point.unstable == Some(0) => {
                    low = middle;
                    best = point;
                }
                _ => high = middle,
            }
        }
        best
    }
}

pub(super) fn path<'s, 'm>(statics: &'s mut Statics<'m>, ramp: Ramp<'s>) -> Path<'s, 'm> {
    let weights = statics.weights();
    Path {
        statics,
        ramp,
        weights,
    }
}

/// The end of the stable path from a state of equilibrium, where it is near.
pub(super) fn path_end(
    statics: &mut Statics<'_>,
    state: &RestState,
    ramp: Ramp<'_>,
    fraction: f64,
) -> Option<PathEnd> {
    let mut path = path(statics, ramp);
    let mut here = path.point(state.clone(), fraction, None)?;
    let mut step = FIRST;
    for _ in 0..STEPS {
        let Some(next) = path.advance(&here, step) else {
            step *= 0.5;
            if step < SMALLEST {
                return None;
            }
            continue;
        };
        let lost = path.lost(&here, step, &next);
        let is_before = |fraction: f64| fraction < 1.0 || here.fraction >= 1.0;
        match lost {
            Some((found, kind)) if is_before(found.fraction) => {
                return Some(PathEnd::Lost(found, kind));
            }
            Some(_) => return path.full(&here).map(PathEnd::Reached),
            None if next.fraction >= 1.0 => {
                let nearest = match 1.0 - here.fraction < next.fraction - 1.0 {
                    true => here,
                    false => next,
                };
                return path.full(&nearest).map(PathEnd::Reached);
            }
            None => {}
        }
        here = next;
        step = (1.5 * step).min(LARGEST);
    }
    None
}

/// States in which all of a load acts, on the path that goes on from a state in a direction: +1 towards larger fractions, −1
/// towards smaller ones. At most `steps` are taken; the path ends at the first stable one, where it leaves the loads between
/// nothing and twice as much, or where a muscle has almost no length.
pub(super) fn crossings(
    statics: &mut Statics<'_>,
    state: &RestState,
    ramp: Ramp<'_>,
    fraction: f64,
    direction: f64,
    steps: usize,
) -> Vec<RestState> {
    let mut found = Vec::new();
    let mut path = path(statics, ramp);
    let Some(mut here) = path.point(state.clone(), fraction, None) else {
        return found;
    };
    here.tangent.0.iter_mut().for_each(|t| *t *= direction);
    here.tangent.1 *= direction;
    let mut step = FIRST;
    for _ in 0..steps {
        let Some(next) = path.advance(&here, step) else {
            step *= 0.5;
            if step < SMALLEST {
                break;
            }
            continue;
        };
        if (here.fraction - 1.0) * (next.fraction - 1.0) < 0.0 {
            let nearest = match (here.fraction - 1.0).abs() < (next.fraction - 1.0).abs() {
                true => &here,
                false => &next,
            };
            if let Some(state) = path.full(nearest) {
                let is_stable = path.statics.unstable() == Some(0);
                found.push(state);
                if is_stable {
                    break;
                }
            }
        }
        here = next;
        let z = path.statics.configuration(&here.state);
        let placed = path.statics.model.action.map.placed(&z);
        let is_short = shortest(path.statics.model, &placed).is_some_and(|(_, s)| s < SHORTEST);
        if is_short || !(-0.5..=2.0).contains(&here.fraction) {
            break;
        }
        step = (1.5 * step).min(LARGEST);
    }
    found
}
