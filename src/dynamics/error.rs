//! Why a step or an equilibrium was not found.

use crate::dynamics::{Equilibrium, Instability};
use thiserror::Error;

/// A step forward in time failed and was not accepted.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum StepError {
    /// Newton's method did not converge, although the step was halved.
    #[error(
        "no convergence of the step from t = {time} ms, even with a step of {step} ms; last residuals relative to the first: {residuals:?}{}",
        hint(residuals)
    )]
    NoConvergence {
        /// Start of the step in ms.
        time: f64,
        /// Smallest step that was tried in ms.
        step: f64,
        /// Residual norms of the last attempt, relative to the first.
        residuals: Vec<f64>,
    },
    /// The tangent is singular.
    #[error(
        "singular tangent at t = {time} ms with a step of {step} ms: {name} is not determined; constraints are redundant, or the configuration is singular"
    )]
    Singular {
        /// Start of the step in ms.
        time: f64,
        /// Step in ms.
        step: f64,
        /// The unknown whose pivot vanished.
        name: String,
    },
}

/// No static equilibrium was found.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum EquilibriumError {
    /// The path of equilibria under growing voltages ends.
    #[error(
        "no equilibrium under these voltages: the path of equilibria under growing voltages ends at {:.6} % of them ({})",
        100.0 * fraction, why(*kind)
    )]
    LimitPoint {
        /// Largest fraction of the voltages for which there was an equilibrium.
        fraction: f64,
        /// How it is lost, where that was found.
        kind: Option<Instability>,
        /// The state there.
        last: Box<Equilibrium>,
    },
    /// There is no equilibrium to start from.
    #[error(
        "no equilibrium even without voltages: gravity or the start are more than the system bears"
    )]
    NoStart,
    /// A part of a block can move freely.
    #[error("{name} is not held: {motion} costs nothing; fix or glue one of its faces")]
    Floating {
        /// The part.
        name: String,
        /// The motion that nothing resists.
        motion: String,
    },
    /// Nothing holds the system.
    #[error(
        "no unique equilibrium: {name} is not determined; nothing holds it, or constraints are redundant"
    )]
    Singular {
        /// The unknown whose pivot vanished.
        name: String,
    },
}

/// What residuals that are not finite mean.
fn hint(residuals: &[f64]) -> &'static str {
    match residuals.iter().any(|r| !r.is_finite()) {
        true => {
            "; an element is turned inside out there (J ≤ 0): take shorter steps from further back"
        }
        false => "",
    }
}

fn why(kind: Option<Instability>) -> &'static str {
    match kind {
        Some(Instability::PullIn) => "pull-in: a limit point",
        Some(Instability::Buckling) => "buckling: another path branches off",
        None => "pull-in or a limit point",
    }
}
