//! Static equilibrium on the path of growing loads: the weights first, then the voltages in steps of V², cut when Newton
//! fails.

use crate::dynamics::equilibrium::arc_length::{KINK, PathEnd, Ramp, STRAIGHT, path_end};
use crate::dynamics::equilibrium::rest_state::{
    Equilibrium, Load, RestState, Route, StabilityLoss,
};
use crate::dynamics::equilibrium::statics::{NewtonOutcome, Statics, UpdateRange};
use crate::dynamics::error::EquilibriumError;
use crate::dynamics::solving::MultigridUse;
use crate::model::{Floating, Model};
use crate::stop;

/// Part of a load that is tried first; of squared voltages.
const FIRST: f64 = 0.25;
/// Largest part of a predicted change by which it may be corrected, and the longest correction.
const BEND: f64 = 0.25;
const LONGEST: f64 = 0.1;
/// Load increments below this end the path.
const SMALLEST: f64 = 1e-6;

/// The static equilibrium under constant voltages (by scalar of an interval) on the path of growing loads from `start`,
/// stable or not.
///
/// # Errors
/// The path ends before all loads act, or nothing holds the system.
pub fn equilibrium(
    model: &Model,
    start: &[f64],
    voltages: &[f64],
) -> Result<Equilibrium, EquilibriumError> {
    let mut statics = begin(model, voltages, MultigridUse::WhereFaster)?;
    let mut state = unloaded(&mut statics, start, voltages)?;
    for load in [Load::Forces, Load::Voltages] {
        let ramp = Ramp { load, voltages };
        let grown = grow(&mut statics, state, ramp)?;
        if grown.fraction < 1.0 {
            statics.fall_back();
            let lost = at_limit(&mut statics, &grown.state, ramp, grown.fraction);
            return Err(stop::unless_stopped(lost));
        }
        state = grown.state;
    }
    statics.examine();
    Ok(Equilibrium::new(
        &mut statics,
        &state,
        voltages,
        Route::Loads,
    ))
}

/// Rows of rest of a model whose blocks are held.
pub(super) fn begin<'m>(
    model: &'m Model,
    inputs: &[f64],
    multigrid: MultigridUse,
) -> Result<Statics<'m>, EquilibriumError> {
    match model.floating() {
        Some(Floating { name, motion }) => Err(EquilibriumError::Floating { name, motion }),
        None => Ok(Statics::by(model, inputs, Some(multigrid))),
    }
}

/// The state of rest without voltages and, where that exists, without weights.
///
/// A robot that only its weight holds has no unique rest without it: then all of it acts at once.
pub(super) fn unloaded(
    statics: &mut Statics<'_>,
    start: &[f64],
    voltages: &[f64],
) -> Result<RestState, EquilibriumError> {
    let mut first = statics.state_without_field(start);
    let none = statics.without_voltages(voltages);
    if statics.has_weight() {
        statics.weight = 0.0;
        let mut state = first.clone();
        if let Ok(NewtonOutcome::Converged) = statics.newton(&mut state, &none, UpdateRange::Far) {
            return Ok(state);
        }
    }
    statics.weight = 1.0;
    match statics.newton(&mut first, &none, UpdateRange::Far)? {
        NewtonOutcome::Converged => Ok(first),
        NewtonOutcome::Failed => Err(EquilibriumError::NoStart),
    }
}

/// State up to which a load has grown.
#[derive(Debug)]
pub(super) struct Grown {
    pub(super) state: RestState,
    pub(super) fraction: f64,
    /// The last state of the path that was stable, and its fraction, where a later one is not.
    pub(super) last_stable: Option<(RestState, f64)>,
}

/// Lets a load grow from nothing, from a state of rest without it, as far as there are equilibria.
///
/// # Errors
/// It was stopped.
pub(super) fn grow(
    statics: &mut Statics<'_>,
    mut state: RestState,
    ramp: Ramp<'_>,
) -> Result<Grown, EquilibriumError> {
    let is_there = match ramp.load {
        // All of the weight acts already where nothing else holds the system.
        Load::Forces => statics.has_weight() && statics.weight < 1.0,
        Load::Voltages => statics.is_driven(ramp.voltages),
    };
    // Blocks bend far within few updates, and have no states of rest far from their path.
    let has_nodes = !statics.model.action.map.of_nodes.is_empty();
    let (mut reached, mut increment) = (0.0, FIRST);
    let mut stable = Some((state.clone(), 0.0));
    let mut is_lost = false;
    // At zero voltage nothing depends on the fraction to first order.
    let mut slope = match ramp.load {
        Load::Forces if is_there => {
            let voltages = ramp.apply(statics, 0.0);
            statics.evaluate(&state, &voltages);
            statics.factor().ok().map(|()| slope(statics, ramp, 0.0))
        }
        _ => None,
    };
    while is_there && reached < 1.0 && increment >= SMALLEST {
        let target = f64::min(reached + increment, 1.0);
        let (mut trial, most) =
            predicted(statics, &state, ramp, [reached, target], slope.as_deref());
        let fraction = ramp.fraction(target);
        let voltages = ramp.apply(statics, fraction);
        if ramp.load == Load::Voltages && statics.settle(&mut trial, &voltages).is_none() {
            stop::check()?;
            increment *= 0.5;
            continue;
        }
        let range = match has_nodes {
            true => UpdateRange::Near,
            false => UpdateRange::Within(most),
        };
        match statics.newton(&mut trial, &voltages, range) {
            Ok(NewtonOutcome::Converged) => {
                let here = self::slope(statics, ramp, fraction);
                let turns = |before: &Vec<f64>| {
                    let length =
                        (target - reached) * statics.size(&before[..statics.scales().len()]);
                    !has_nodes && length > KINK && !is_straight(statics, before, &here)
                };
                if slope.as_ref().is_some_and(turns) {
                    increment *= 0.5;
                    continue;
                }
                (state, reached, slope) = (trial, target, Some(here));
                increment *= 2.0;
                match statics.unstable() {
                    Some(1..) => is_lost = true,
                    _ if !is_lost => stable = Some((state.clone(), fraction)),
                    _ => {}
                }
            }
            Err(stopped @ EquilibriumError::Stopped(_)) => return Err(stopped),
            Ok(NewtonOutcome::Failed) | Err(_) => increment *= 0.5,
        }
    }
    let fraction = if is_there {
        ramp.fraction(reached)
    } else {
        1.0
    };
    Ok(Grown {
        state,
        fraction,
        last_stable: stable.filter(|_| is_lost),
    })
}

/// Derivative of the state by the part of a load, at the fraction evaluated and factorised last.
fn slope(statics: &mut Statics<'_>, ramp: Ramp<'_>, fraction: f64) -> Vec<f64> {
    let by_part = ramp.slope(fraction);
    ramp.response(statics).iter().map(|v| by_part * v).collect()
}

/// Returns true if a path with these derivatives at both ends of a step hardly turns within it.
fn is_straight(statics: &Statics<'_>, before: &[f64], after: &[f64]) -> bool {
    let weights = &statics.weights()[..statics.scales().len()];
    let dot = |a: &[f64], b: &[f64]| {
        let products = a.iter().zip(b).zip(weights).map(|((a, b), w)| a * b * w);
        1.0 + products.sum::<f64>()
    };
    dot(before, after) > STRAIGHT * (dot(before, before) * dot(after, after)).sqrt()
}

/// The state on the tangent of a path from one part of a load to another, and the longest correction from there; without a tangent the
/// same state. Potentials grow with the voltages.
fn predicted(
    statics: &Statics<'_>,
    state: &RestState,
    ramp: Ramp<'_>,
    [reached, target]: [f64; 2],
    slope: Option<&[f64]>,
) -> (RestState, f64) {
    let (n, m) = (statics.scales().len(), statics.model.action.map.unknowns());
    let (mut trial, most) = match slope {
        None => (state.clone(), LONGEST),
        Some(slope) => {
            let step = target - reached;
            let moved = statics.moved(state, step, &slope[..m]);
            (
                moved,
                f64::min(BEND * step * statics.size(&slope[..n]), LONGEST),
            )
        }
    };
    if let (Load::Voltages, true) = (ramp.load, reached > 0.0) {
        let growth = (target / reached).sqrt();
        trial[m..].iter_mut().for_each(|p| *p *= growth);
    }
    (trial, most)
}

/// Returns the end of the path at a state: the limit point next to it, or the last equilibrium.
pub(super) fn at_limit(
    statics: &mut Statics<'_>,
    state: &RestState,
    ramp: Ramp<'_>,
    fraction: f64,
) -> EquilibriumError {
    let end = path_end(statics, state, ramp, fraction);
    let (fraction, kind, last) = match end {
        Some(PathEnd::Lost(at, kind)) => (at.fraction, Some(kind), at.state),
        Some(PathEnd::Reached(_)) | None => (fraction, None, state.clone()),
    };
    let loss = StabilityLoss {
        load: ramp.load,
        fraction,
        kind,
    };
    let voltages = ramp.apply(statics, fraction);
    let last = Equilibrium::new(statics, &last, &voltages, Route::Beyond(loss));
    EquilibriumError::LimitPoint {
        loss,
        last: Box::new(last),
    }
}
