//! Settings of the integration of a motion: the method, and the solution of the equations of a step.

use crate::model::system::{Fidelity, System};
use crate::sparse::Backend;

/// The method that leads from one instant to the next.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Integrator {
    /// The midpoint variational integrator: the equations of the transcription, order 2.
    #[default]
    Midpoint,
    /// A Galerkin variational integrator with Lobatto points, order 2 × degree.
    Galerkin {
        /// Degree of the motion within a step, 1 or more.
        degree: usize,
    },
    /// Implicit Euler, order 1; damps.
    ImplicitEuler,
    /// The generalised-α method for constrained systems, order 2; damps fast oscillations.
    GeneralisedAlpha {
        /// Factor by which the fastest oscillations shrink in a step, from 0 to 1.
        spectral_radius: f64,
    },
}

impl Integrator {
    /// Order of the method in the step.
    pub fn order(self) -> usize {
        match self {
            Self::Midpoint | Self::GeneralisedAlpha { .. } => 2,
            Self::Galerkin { degree } => 2 * degree,
            Self::ImplicitEuler => 1,
        }
    }

    /// The word in files and tables.
    pub fn name(self) -> String {
        match self {
            Self::Midpoint => "midpoint".to_owned(),
            Self::Galerkin { degree } => format!("galerkin {degree}"),
            Self::ImplicitEuler => "implicit euler".to_owned(),
            Self::GeneralisedAlpha { spectral_radius } => {
                format!("generalised alpha {spectral_radius}")
            }
        }
    }
}

/// Occasions at which the tangent of a step is factorised.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Newton {
    /// In every iteration: few iterations, each with a factorisation.
    #[default]
    Full,
    /// The modified Newton method: only where the last factorisation, of an iteration or of a step before, converges too slowly.
    Modified,
}

/// The method and how its equations are solved.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Solving {
    /// The method.
    pub integrator: Integrator,
    /// Occasions at which the tangent is factorised.
    pub newton: Newton,
    /// Method of its factorisation; `None`: the one that is fastest as a rule.
    pub backend: Option<Backend>,
}

impl Newton {
    /// Returns the setting that suits a system: the factorisation of finite elements is worth keeping, that of a few joint coordinates is not
    /// (benches/README.md).
    pub fn for_system(system: &System) -> Self {
        let mut muscles = system.muscles.iter();
        let of_muscles = muscles.any(|muscle| muscle.fidelity != Fidelity::Lumped);
        match of_muscles || !system.solids.is_empty() {
            true => Self::Modified,
            false => Self::Full,
        }
    }
}
