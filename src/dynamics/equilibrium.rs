//! Static equilibrium: voltages grow in steps of V², cut when Newton fails.

use crate::dynamics::statics::{Outcome, State, Statics};
use crate::dynamics::{EquilibriumError, LimitPoint, limit_point};
use crate::model::{Floating, Model};
use nalgebra::{DMatrix, SymmetricEigen};

/// Fraction of the load (in V²) that is tried first.
const FIRST: f64 = 0.25;
/// Load increments below this end the path.
const SMALLEST: f64 = 1e-6;
/// Up to so many coordinates the stiffness is looked at eigenvalue by eigenvalue.
const EIGENVALUES: usize = 100;

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
    /// Newton iterations over all loads.
    pub iterations: usize,
}

impl Equilibrium {
    /// Whether the equilibrium is stable; `None` where that is not known.
    pub fn is_stable(&self) -> Option<bool> {
        match self.stiffness.first() {
            Some(&smallest) => Some(smallest > 0.0),
            None => self.unstable.map(|count| count == 0),
        }
    }

    /// A state of rest of a model, from coordinates with multipliers and potentials.
    pub(super) fn new(statics: &mut Statics<'_>, state: &[f64], voltages: &[f64]) -> Self {
        let m = statics.model.action.motion.unknowns();
        statics.evaluate(state, voltages);
        let known = statics.factor().is_ok();
        Self {
            z: state[..m].to_vec(),
            scalars: voltages.iter().chain(&state[m..]).copied().collect(),
            stiffness: stiffness(statics),
            unstable: known.then(|| statics.unstable()).flatten(),
            iterations: statics.iterations,
        }
    }
}

/// Eigenvalues of the stiffness of a small system in joint coordinates, at the state evaluated last.
fn stiffness(statics: &Statics<'_>) -> Vec<f64> {
    let model = statics.model;
    let motion = &model.action.motion;
    let n = motion.unknowns();
    let joints_alone = motion.tree.is_some() && motion.of_nodes.is_empty();
    if motion.multipliers > 0 || !joints_alone || !(1..=EIGENVALUES).contains(&n) {
        return Vec::new();
    }
    let mut matrix = DMatrix::<f64>::zeros(n, n);
    for ((row, col), value) in statics.entries() {
        matrix[(row, col)] -= value / model.multiplier_time;
    }
    let values = SymmetricEigen::new(matrix).eigenvalues;
    let mut eigenvalues: Vec<f64> = values.iter().copied().collect();
    eigenvalues.sort_by(f64::total_cmp);
    eigenvalues
}

/// The static equilibrium under constant voltages (by scalar of an interval), on the path from `start`.
///
/// # Errors
/// The path ends before the voltages are reached, or nothing holds the system.
pub fn equilibrium(
    model: &Model,
    start: &[f64],
    voltages: &[f64],
) -> Result<Equilibrium, EquilibriumError> {
    if let Some(Floating { name, motion }) = model.floating() {
        return Err(EquilibriumError::Floating { name, motion });
    }
    let mut statics = Statics::new(model);
    let mut state: State = start.to_vec();
    state.resize(start.len() + model.potentials, 0.0);
    let loaded = |fraction: f64| -> Vec<f64> {
        let factor = fraction.sqrt();
        voltages.iter().map(|v| v * factor).collect()
    };
    let (mut reached, mut increment) = (0.0, FIRST);
    if statics.newton(&mut state, &loaded(0.0))? == Outcome::Failed {
        return Err(EquilibriumError::NoStart);
    }
    while reached < 1.0 && voltages.iter().any(|&v| v != 0.0) {
        let target = f64::min(reached + increment, 1.0);
        let mut trial = state.clone();
        // Potentials grow with the voltages.
        let growth = if reached > 0.0 {
            (target / reached).sqrt()
        } else {
            1.0
        };
        trial[start.len()..].iter_mut().for_each(|p| *p *= growth);
        match statics.newton(&mut trial, &loaded(target)) {
            Ok(Outcome::Converged) => {
                (state, reached) = (trial, target);
                increment *= 2.0;
            }
            Err(stopped @ EquilibriumError::Stopped(_)) => return Err(stopped),
            Ok(Outcome::Failed) | Err(_) => increment *= 0.5,
        }
        if increment < SMALLEST {
            return Err(at_limit(&mut statics, &state, voltages, reached.sqrt()));
        }
    }
    Ok(Equilibrium::new(&mut statics, &state, voltages))
}

/// Why the path ends at a state: the limit point next to it, or the last equilibrium.
fn at_limit(
    statics: &mut Statics<'_>,
    state: &[f64],
    voltages: &[f64],
    fraction: f64,
) -> EquilibriumError {
    let found = limit_point(statics, state, voltages, fraction);
    let (fraction, kind, last) = match found {
        Some(LimitPoint {
            fraction,
            kind,
            state,
        }) => (fraction, Some(kind), state),
        None => (fraction, None, state.to_vec()),
    };
    let voltages: Vec<f64> = voltages.iter().map(|v| v * fraction).collect();
    EquilibriumError::LimitPoint {
        fraction,
        kind,
        last: Box::new(Equilibrium::new(statics, &last, &voltages)),
    }
}
