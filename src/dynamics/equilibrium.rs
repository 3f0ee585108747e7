//! Static equilibrium on the path of growing loads: the weights first, then the voltages in steps of V², cut when Newton
//! fails.

use crate::dynamics::ramp::{Load, Ramp};
use crate::dynamics::softest::{Mode, softest, stiffness};
use crate::dynamics::statics::{NewtonOutcome, RestState, Statics, UpdateRange};
use crate::dynamics::{EquilibriumError, Instability, LimitPoint, limit_point};
use crate::model::{Floating, Model};

/// Part of a load that is tried first, in V² for voltages.
const FIRST: f64 = 0.25;
/// Load increments below this end the path.
const SMALLEST: f64 = 1e-6;

/// A state of rest.
#[derive(Clone, Debug, PartialEq)]
pub struct Equilibrium {
    /// Coordinates and multipliers.
    pub z: Vec<f64>,
    /// Voltages and potentials.
    pub scalars: Vec<f64>,
    /// Eigenvalues of the stiffness in joint coordinates, ascending, in N mm/rad or N/mm; empty in redundant coordinates
    /// and for elastic blocks.
    pub stiffness: Vec<f64>,
    /// Number of directions in which the potential energy falls, by the inertia of the tangent; `None` where the
    /// factorisation does not tell.
    pub unstable: Option<usize>,
    /// The softest mode; `None` at the points of a path, and where nothing moves.
    pub softest: Option<Mode>,
    /// How it was found.
    pub route: Route,
    /// Newton iterations over all loads.
    pub iterations: usize,
}

/// How an equilibrium was found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Route {
    /// On the path of growing loads: the weights, then the voltages.
    Loads,
    /// On the path that goes on beyond the point where growing loads lose their equilibrium, and comes back to all loads.
    Beyond(StabilityLoss),
    /// At a minimum of the potential energy, downhill from a state where the path ends or is unstable.
    Minimum(StabilityLoss),
}

/// Where the path of growing loads loses its stable equilibrium.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StabilityLoss {
    /// The load that grew.
    pub load: Load,
    /// Its fraction.
    pub fraction: f64,
    /// How, where that was found.
    pub kind: Option<Instability>,
}

impl Equilibrium {
    /// Whether the equilibrium is stable; `None` where that is not known.
    pub fn is_stable(&self) -> Option<bool> {
        match self.stiffness.first() {
            Some(&smallest) => Some(smallest > 0.0),
            None => self.unstable.map(|count| count == 0),
        }
    }

    /// Where growing loads lose the stable equilibrium, if it does not lie on their path.
    pub fn loss(&self) -> Option<StabilityLoss> {
        match self.route {
            Route::Loads => None,
            Route::Beyond(loss) | Route::Minimum(loss) => Some(loss),
        }
    }

    /// Stiffness, stability and softest mode of a model's state of rest: `z` of coordinates and multipliers, `scalars` of
    /// voltages and potentials.
    pub fn of_state(model: &Model, z: &[f64], scalars: &[f64]) -> Self {
        let mut statics = Statics::new(model);
        let (voltages, potentials) = scalars.split_at(model.voltages.len());
        let state = statics.state(z, potentials);
        Self::new(&mut statics, &state, voltages, Route::Loads)
    }

    /// A state of rest of a model, from coordinates with multipliers and potentials.
    pub(super) fn new(
        statics: &mut Statics<'_>,
        state: &[f64],
        voltages: &[f64],
        route: Route,
    ) -> Self {
        let state = &statics.recentred(state);
        let point = Self::on_path(statics, state, voltages, route);
        Self {
            softest: softest(statics, state, voltages),
            ..point
        }
    }

    /// The same without its softest mode.
    pub(super) fn on_path(
        statics: &mut Statics<'_>,
        state: &[f64],
        voltages: &[f64],
        route: Route,
    ) -> Self {
        let m = statics.model.action.motion.unknowns();
        statics.evaluate(state, voltages);
        let is_known = statics.factor().is_ok();
        Self {
            z: statics.configuration(state),
            scalars: voltages.iter().chain(&state[m..]).copied().collect(),
            stiffness: stiffness(statics),
            unstable: is_known.then(|| statics.unstable()).flatten(),
            softest: None,
            route,
            iterations: statics.iterations,
        }
    }
}

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
    let mut statics = begin(model)?;
    let mut state = unloaded(&mut statics, start, voltages)?;
    for load in [Load::Weight, Load::Voltages] {
        let ramp = Ramp { load, voltages };
        let grown = grow(&mut statics, state, ramp)?;
        if grown.fraction < 1.0 {
            return Err(at_limit(&mut statics, &grown.state, ramp, grown.fraction));
        }
        state = grown.state;
    }
    Ok(Equilibrium::new(
        &mut statics,
        &state,
        voltages,
        Route::Loads,
    ))
}

/// Rows of rest of a model whose blocks are held.
pub(super) fn begin(model: &Model) -> Result<Statics<'_>, EquilibriumError> {
    match model.floating() {
        Some(Floating { name, motion }) => Err(EquilibriumError::Floating { name, motion }),
        None => Ok(Statics::new(model)),
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
    let mut first = statics.state(start, &vec![0.0; statics.model.potentials]);
    let none = vec![0.0; voltages.len()];
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

/// How far a load has grown.
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
    let m = statics.model.action.motion.unknowns();
    let is_there = match ramp.load {
        // All of the weight acts already where nothing else holds the system.
        Load::Weight => statics.has_weight() && statics.weight < 1.0,
        Load::Voltages => ramp.voltages.iter().any(|&v| v != 0.0),
    };
    let (mut reached, mut increment) = (0.0, FIRST);
    let mut stable = Some((state.clone(), 0.0));
    let mut is_lost = false;
    while is_there && reached < 1.0 && increment >= SMALLEST {
        let target = f64::min(reached + increment, 1.0);
        let mut trial = state.clone();
        // Potentials grow with the voltages.
        let growth = match (ramp.load, reached > 0.0) {
            (Load::Voltages, true) => (target / reached).sqrt(),
            _ => 1.0,
        };
        trial[m..].iter_mut().for_each(|p| *p *= growth);
        let fraction = ramp.fraction(target);
        let voltages = ramp.apply(statics, fraction);
        match statics.newton(&mut trial, &voltages, UpdateRange::Near) {
            Ok(NewtonOutcome::Converged) => {
                (state, reached) = (trial, target);
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

/// Why the path ends at a state: the limit point next to it, or the last equilibrium.
pub(super) fn at_limit(
    statics: &mut Statics<'_>,
    state: &[f64],
    ramp: Ramp<'_>,
    fraction: f64,
) -> EquilibriumError {
    let found = limit_point(statics, state, ramp, fraction);
    let (fraction, kind, last) = match found {
        Some(LimitPoint {
            fraction,
            kind,
            state,
        }) => (fraction, Some(kind), state),
        None => (fraction, None, state.to_vec()),
    };
    let loss = StabilityLoss {
        load: ramp.load,
        fraction,
        kind,
    };
    let voltages = ramp.apply(statics, fraction);
    EquilibriumError::LimitPoint {
        fraction,
        kind,
        load: ramp.load,
        last: Box::new(Equilibrium::new(
            statics,
            &last,
            &voltages,
            Route::Beyond(loss),
        )),
    }
}
