//! A stable equilibrium under all loads, found in a fixed order:
//!
//! 1. on the path of growing loads, the weights first, then the voltages;
//! 2. where that path turns back or is unstable, on its continuation by arc length, where all loads act again;
//! 3. where damped motion comes to rest, from the unstable states met, from where the path is lost, and from where no load acts, to
//!    either side of their softest modes.
//!
//! The first stable one is the answer.
//!
//! Equilibrium in redundant coordinates by way of joint coordinates, where these exist.
//!
//! Both are the same states. In joint coordinates far ones are reached, as no update leaves the constraints; a state found there is one of
//! the redundant coordinates up to Newton's method from nearby, which finds the multipliers.
//!
//! Equilibria along the path of growing voltages, past limit points.

use crate::dynamics::equilibrium::arc_length::{
    FIRST, LARGEST, PathEnd, PathPoint, Ramp, SMALLEST, crossings, path, path_end,
};
use crate::dynamics::equilibrium::growth::{Grown, at_limit, begin, grow, unloaded};
use crate::dynamics::equilibrium::relaxation::relax;
use crate::dynamics::equilibrium::rest_state::{
    Equilibrium, Instability, Load, RestState, Route, StabilityLoss,
};
use crate::dynamics::equilibrium::softest_mode::softest_mode;
use crate::dynamics::equilibrium::statics::{NewtonOutcome, Statics, UpdateRange};
use crate::dynamics::error::EquilibriumError;
use crate::dynamics::solving::MultigridUse;
use crate::model::{Analysis, Coordinates, Model};
use crate::stop;

/// Steps along a path beyond its limit point, and those for models with nodes.
const STEPS: [usize; 2] = [300, 40];
/// Length of a push along the softest mode, in radians and lengths of the system.
const PUSH: f64 = 0.05;
/// Largest number of halvings of a push where it has no energy.
const HALVINGS: usize = 8;
/// Relative difference of the energies of two states alike.
const ALIKE: f64 = 1e-9;
/// Stiffness below this part of the largest is none.
const ROUND_OFF: f64 = 1e-13;

/// The stable equilibrium under constant voltages (by scalar of an interval); an unstable one where growing loads lead there
/// and no stable one was found.
///
/// # Errors
/// No equilibrium was found, or nothing holds the system.
pub fn stable_equilibrium(
    model: &Model,
    start: &[f64],
    voltages: &[f64],
) -> Result<Equilibrium, EquilibriumError> {
    stable_equilibrium_by(model, start, voltages, MultigridUse::WhereFaster)
}

/// The same, with an iteration where it is wanted: its stability is examined by factors up to a size, by the lowest mode above.
///
/// # Errors
/// As of [`stable_equilibrium`].
pub fn stable_equilibrium_by(
    model: &Model,
    start: &[f64],
    voltages: &[f64],
    multigrid: MultigridUse,
) -> Result<Equilibrium, EquilibriumError> {
    let found = found(model, start, voltages, multigrid);
    found.map_err(stop::unless_stopped)
}

/// The same, whose errors may be those of a way that was stopped.
fn found(
    model: &Model,
    start: &[f64],
    voltages: &[f64],
    multigrid: MultigridUse,
) -> Result<Equilibrium, EquilibriumError> {
    let mut statics = begin(model, voltages, multigrid)?;
    if let Some(twin) = joint_twin(model) {
        let start = carried(model, start, &twin);
        let found = stable_equilibrium(&twin, &start, voltages);
        if let Err(error @ EquilibriumError::Stopped(_)) = found {
            return Err(error);
        }
        let confirm = |found| confirmed(&mut statics, &twin, &found, voltages);
        if let Some(found) = found.ok().map(confirm).transpose()?.flatten() {
            return Ok(found);
        }
    }
    let none = statics.without_voltages(voltages);
    let is_driven = statics.is_driven(voltages);
    let weighed = under_weight(&mut statics, start, &none, !is_driven);
    match (weighed, is_driven) {
        (Err(EquilibriumError::LimitPoint { loss, last }), true) => {
            // Under voltages there may be an equilibrium where there is none without.
            let state = statics.state_without_field(&last.z);
            let found = come_to_rest(&mut statics, &[state], voltages)?;
            let found = found.ok_or(EquilibriumError::LimitPoint { loss, last })?;
            let route = Route::DampedMotion(loss);
            Ok(Equilibrium::new(&mut statics, &found, voltages, route))
        }
        (weighed, false) => {
            let (state, route) = weighed?;
            statics.weight = 1.0;
            Ok(Equilibrium::new(&mut statics, &state, &none, route))
        }
        (weighed, true) => {
            let (rest, route) = weighed?;
            let ramp = Ramp {
                load: Load::Voltages,
                voltages,
            };
            statics.weight = 1.0;
            let (state, after) = under(&mut statics, rest, ramp, true)?;
            let route = match after {
                Route::Loads => route,
                other => other,
            };
            statics.weight = 1.0;
            Ok(Equilibrium::new(&mut statics, &state, voltages, route))
        }
    }
}

/// Rest without voltages.
fn under_weight(
    statics: &mut Statics<'_>,
    start: &[f64],
    none: &[f64],
    is_last: bool,
) -> Result<(RestState, Route), EquilibriumError> {
    let ramp = Ramp {
        load: Load::Forces,
        voltages: none,
    };
    let begun = match unloaded(statics, start, none) {
        Err(stopped @ EquilibriumError::Stopped(_)) => return Err(stopped),
        begun => begun,
    };
    // Where an iteration leads, stability is examined under all loads.
    let is_stable = begun.is_ok() && (statics.is_iterated() || statics.unstable() == Some(0));
    if is_stable || (begun.is_ok() && statics.weight < 1.0) {
        return under(statics, begun?, ramp, is_last);
    }
    statics.fall_back();
    // Nothing but weights holds the system, or its reference is far from rest.
    let first = statics.state_without_field(start);
    let from = match &begun {
        Ok(state) => vec![state.clone(), first],
        Err(_) => vec![first],
    };
    statics.weight = 1.0;
    let loss = StabilityLoss {
        load: Load::Forces,
        fraction: 0.0,
        kind: None,
    };
    match come_to_rest(statics, &from, none)? {
        Some(found) => Ok((found, Route::DampedMotion(loss))),
        None => match begun {
            Ok(state) => Ok((state, Route::Loads)),
            Err(error) => Err(without_stiffness(statics, start, none).unwrap_or(error)),
        },
    }
}

/// Joints whose coordinates no force depends on, near a start and with all weights acting.
fn without_stiffness(
    statics: &mut Statics<'_>,
    start: &[f64],
    none: &[f64],
) -> Option<EquilibriumError> {
    let model = statics.model;
    if !model.has_independent_joints() {
        return None;
    }
    let mut aside = statics.state_without_field(start);
    let turns = aside[..model.action.map.of_bodies].iter_mut();
    turns.for_each(|value| *value += PUSH);
    statics.weight = 1.0;
    statics.evaluate(&aside, none);
    statics.leave_out_curvature();
    statics.factor().ok();
    let mut largest = vec![0.0_f64; model.coordinate_count()];
    for ((row, col), value) in statics.entries() {
        if row < largest.len() && col < largest.len() {
            largest[row] = largest[row].max(value.abs());
        }
    }
    let all = largest.iter().copied().fold(0.0, f64::max);
    let slack = (0..model.action.map.of_bodies)
        .filter(|&c| largest[c] <= ROUND_OFF * all && !model.is_prescribed(c));
    let mut names: Vec<String> = slack.map(|c| model.freedom(c).of.to_owned()).collect();
    names.dedup();
    (!names.is_empty()).then_some(EquilibriumError::NoStiffness(names))
}

/// The equilibrium under all of a load, from one without it.
fn under(
    statics: &mut Statics<'_>,
    rest: RestState,
    ramp: Ramp<'_>,
    is_last: bool,
) -> Result<(RestState, Route), EquilibriumError> {
    let Grown {
        state,
        fraction,
        last_stable,
    } = grow(statics, rest.clone(), ramp)?;
    let is_reached = fraction >= 1.0;
    let voltages = ramp.apply(statics, 1.0);
    if is_reached && is_last {
        statics.examine();
    }
    if is_reached && is_stable(statics, &state, &voltages) != Some(false) {
        return Ok((state, Route::Loads));
    }
    statics.fall_back();
    if is_reached && statics.is_iterated() {
        // There is no room for the factors by which other states are sought.
        return Ok((state, Route::Loads));
    }
    // Where it was lost: the limit point from the last stable state on.
    let (before, at) = last_stable.unwrap_or((state.clone(), fraction));
    let limit = match path_end(statics, &before, ramp, at) {
        Some(PathEnd::Reached(found)) => {
            ramp.apply(statics, 1.0);
            if is_stable(statics, &found, &voltages) != Some(false) {
                return Ok((found, Route::Loads));
            }
            None
        }
        Some(PathEnd::Lost(point, kind)) => Some((point, kind)),
        None => None,
    };
    let loss = StabilityLoss {
        load: ramp.load,
        fraction: limit.as_ref().map_or(at, |(point, _)| point.fraction),
        kind: limit.as_ref().map(|(_, kind)| *kind),
    };
    let steps = STEPS[usize::from(!statics.model.action.map.of_nodes.is_empty())];
    let (from, directions) = match is_reached {
        true => (1.0, &[1.0, -1.0][..]),
        false => (fraction, &[1.0][..]),
    };
    let mut met: Vec<RestState> = Vec::new();
    if is_reached {
        met.push(state.clone());
    }
    for &direction in directions {
        let crossed = crossings(statics, &state, ramp, from, direction, steps);
        for found in crossed {
            ramp.apply(statics, 1.0);
            if is_stable(statics, &found, &voltages) == Some(true) {
                return Ok((found, Route::Beyond(loss)));
            }
            met.push(found);
        }
    }
    met.extend(limit.map(|(point, _)| point.state));
    met.extend([before, rest]);
    ramp.apply(statics, 1.0);
    if let Some(found) = come_to_rest(statics, &met, &voltages)? {
        return Ok((found, Route::DampedMotion(loss)));
    }
    ramp.apply(statics, 1.0);
    match is_reached {
        true => Ok((state, Route::Loads)),
        false => Err(at_limit(statics, &state, ramp, fraction)),
    }
}

/// Returns true if a state of rest is stable; `None` where that is not known.
fn is_stable(statics: &mut Statics<'_>, state: &RestState, voltages: &[f64]) -> Option<bool> {
    statics.evaluate(state, voltages);
    statics.factor().ok()?;
    statics.unstable_anyhow().map(|count| count == 0)
}

/// The first stable equilibrium to which damped motion leads from one of some states.
///
/// # Errors
/// It was stopped.
fn come_to_rest(
    statics: &mut Statics<'_>,
    from: &[RestState],
    voltages: &[f64],
) -> Result<Option<RestState>, EquilibriumError> {
    for state in from {
        if let Some(found) = beside(statics, state, voltages)? {
            return Ok(Some(found));
        }
    }
    Ok(None)
}

/// The stable equilibrium to which damped motion leads from a state, pushed to either side along its softest mode; where both sides lead to
/// one, that of less potential energy.
fn beside(
    statics: &mut Statics<'_>,
    state: &RestState,
    voltages: &[f64],
) -> Result<Option<RestState>, EquilibriumError> {
    if statics.is_iterated() {
        return Ok(None);
    }
    statics.weight = 1.0;
    statics.evaluate(state, voltages);
    // At a limit point the tangent is singular, and still the lowest eigenvalue has its direction.
    statics.factor().ok();
    let Some(mode) = softest_mode(statics, state, voltages) else {
        return Ok(None);
    };
    let mut lowest: Option<(RestState, f64)> = None;
    for side in [PUSH, -PUSH] {
        let pushed = pushed(statics, state, voltages, &mode.direction, side);
        let rests = pushed.and_then(|pushed| relax(statics, &pushed, voltages));
        let Some(mut found) = rests else {
            continue;
        };
        statics.weight = 1.0;
        let outcome = statics.newton(&mut found, voltages, UpdateRange::Near);
        if outcome != Ok(NewtonOutcome::Converged)
            || is_stable(statics, &found, voltages) != Some(true)
        {
            continue;
        }
        let energy = statics.energy(&found, voltages);
        // Of two sides alike the first one counts, whatever rounding says.
        let is_lower = |least: f64| least - energy > ALIKE * least.abs();
        if lowest.as_ref().is_none_or(|(_, least)| is_lower(*least)) {
            lowest = Some((found, energy));
        }
    }
    // One side that was not followed to its end may have the lower energy.
    stop::check()?;
    Ok(lowest.map(|(found, _)| found))
}

/// A state pushed along a direction, as far as it has energy there.
fn pushed(
    statics: &mut Statics<'_>,
    state: &RestState,
    voltages: &[f64],
    direction: &[f64],
    mut by: f64,
) -> Option<RestState> {
    for _ in 0..HALVINGS {
        let mut moved = statics.moved(state, by, direction);
        if statics.settle(&mut moved, voltages).is_some()
            && statics.energy(&moved, voltages).is_finite()
        {
            return Some(moved);
        }
        by *= 0.5;
    }
    None
}

/// The same system in joint coordinates; `None` where the coordinates are these already, where joints close loops, and where nodes are
/// unknowns, which are others in other coordinates.
pub(super) fn joint_twin(model: &Model) -> Option<Model> {
    let is_other = model.coordinates == Coordinates::Redundant && !model.has_loops();
    if !is_other || !model.solids.is_empty() {
        return None;
    }
    let analysis = Analysis {
        coordinates: Some(Coordinates::Reduced),
        quantities: Vec::new(),
        curved: Default::default(),
        ..model.analysis.clone()
    };
    Model::for_analysis(model.system.clone(), analysis).ok()
}

/// Coordinates of one model at a configuration of the other.
pub(super) fn carried(from: &Model, z: &[f64], to: &Model) -> Vec<f64> {
    let instant = from.action.map.placed(z);
    let joints = from.joints(&instant, &vec![0.0; from.joint_readings.len()]);
    to.coordinates_of_poses(&from.poses(&instant), &joints)
}

/// A state of rest of the twin as one of the model; `None` where Newton's method does not confirm it.
///
/// # Errors
/// It was stopped.
pub(super) fn confirmed(
    statics: &mut Statics<'_>,
    twin: &Model,
    found: &Equilibrium,
    voltages: &[f64],
) -> Result<Option<Equilibrium>, EquilibriumError> {
    let z = carried(twin, &found.z, statics.model);
    let mut state = statics.state_without_field(&z);
    statics.weight = 1.0;
    match statics.newton(&mut state, voltages, UpdateRange::Near) {
        Ok(NewtonOutcome::Converged) => {
            let mut own = Equilibrium::new(statics, &state, voltages, found.route);
            own.iterations += found.iterations;
            Ok(Some(own))
        }
        Err(error @ EquilibriumError::Stopped(_)) => Err(error),
        Ok(NewtonOutcome::Failed) | Err(_) => Ok(None),
    }
}

/// An equilibrium of a path.
#[derive(Clone, Debug)]
pub struct PathStop {
    /// The equilibrium.
    pub rest: Equilibrium,
    /// Fraction of the voltages.
    pub fraction: f64,
    /// Kind of instability by which stability is lost here; none of a point of the path.
    pub lost: Option<Instability>,
}

/// Follows the path of equilibria from zero voltage by arc length for `steps` points, past limit points; where stability is lost between two of
/// them there is one more stop.
///
/// # Errors
/// There is no equilibrium without voltages, or nothing holds the system.
pub fn continuation(
    model: &Model,
    start: &[f64],
    voltages: &[f64],
    steps: usize,
) -> Result<Vec<PathStop>, EquilibriumError> {
    // At zero voltage nothing depends on the fraction to first order: the path starts a little further.
    let ramp = Ramp {
        load: Load::Voltages,
        voltages,
    };
    let mut statics = Statics::new(model, voltages);
    let beginning = ramp.apply(&mut statics, FIRST);
    let first = stable_equilibrium(model, start, &beginning)?;
    let [_, scalars] = model.variables.split(&first.scalars);
    let state = statics.state(&first.z, scalars);
    let mut path = path(&mut statics, ramp);
    let mut out = vec![PathStop {
        rest: first,
        fraction: FIRST,
        lost: None,
    }];
    let mut points = 1;
    let Some(mut here) = path.point(state, FIRST, None) else {
        return Ok(out);
    };
    let mut step = FIRST;
    while points < steps {
        let Some(next) = path.advance(&here, step) else {
            step *= 0.5;
            if step < SMALLEST {
                break;
            }
            continue;
        };
        let limit = path.lost(&here, step, &next);
        // A search that was stopped ends elsewhere than where stability is lost.
        if stop::reason().is_some() {
            break;
        }
        let mut add = |point: &PathPoint, lost: Option<Instability>| {
            let loaded = ramp.apply(path.statics, point.fraction);
            out.push(PathStop {
                rest: Equilibrium::on_path(path.statics, &point.state, &loaded, Route::Loads),
                fraction: point.fraction,
                lost,
            });
        };
        if let Some((point, kind)) = limit {
            add(&point, Some(kind));
        }
        add(&next, None);
        points += 1;
        here = next;
        step = (1.5 * step).min(LARGEST);
    }
    Ok(out)
}
