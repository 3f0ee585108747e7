//! Settings of the integration of a motion: the method, and the solution of the equations of a step.

use crate::model::Model;
use crate::model::system::{Fidelity, Solid, System};
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
    /// Solution of the linear systems of blocks by an iteration with multigrid.
    pub multigrid: MultigridUse,
}

/// Use of an iteration with multigrid, where all unknowns are at nodes of blocks.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum MultigridUse {
    /// For large systems for which no factorisation is named.
    #[default]
    WhereFaster,
    /// For systems of any size.
    Always,
    /// For systems of any size, without factors that take over.
    Alone,
}

/// Number of unknowns from which on the iteration is faster, as `benches/multigrid.rs` measures.
const LARGE: usize = 20_000;
/// The same where a mesh is no box.
const LARGE_MESH: usize = 50_000;

impl Solving {
    /// Returns true if an iteration may solve for the unknowns of a step.
    pub fn may_iterate(&self) -> bool {
        let is_midpoint = self.integrator == Integrator::Midpoint;
        is_midpoint && (self.backend.is_none() || self.multigrid.is_asked_for())
    }

    /// Returns true if the unknowns of a model, where nodes have all of them, are solved for by an iteration.
    pub(super) fn takes_grids(&self, model: &Model) -> bool {
        let is_box = |solid: &Solid| solid.mesh.box_planes().is_some();
        let is_large = || {
            let unknowns = model.variables.unknown_count();
            unknowns > LARGE_MESH || unknowns > LARGE && model.system.solids.iter().all(is_box)
        };
        match self.multigrid {
            MultigridUse::Always | MultigridUse::Alone => true,
            MultigridUse::WhereFaster => self.backend.is_none() && is_large(),
        }
    }
}

impl MultigridUse {
    /// Returns true if it is used whatever the size.
    pub fn is_asked_for(self) -> bool {
        self != Self::WhereFaster
    }
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

/// Voltages in V as functions of time, by scalar of an interval.
pub trait Drive {
    /// Those at a part, from 0 to 1, of a step between two times in ms; at its ends the limits from within the step.
    fn at(&self, step: [f64; 2], part: f64) -> Vec<f64>;

    /// Those at both ends of a step; `None` where they are constant over the steps.
    fn ends(&self, _step: [f64; 2]) -> Option<[Inputs; 2]> {
        None
    }
}

/// Inputs at an end of a step, as the limits from within the step, by scalar of an interval.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Inputs {
    /// Values in V and units of loads.
    pub values: Vec<f64>,
    /// Their rates per ms.
    pub rates: Vec<f64>,
}

/// Voltages that are constant over each step: a function of its two times.
impl<F: Fn(f64, f64) -> Vec<f64>> Drive for F {
    fn at(&self, [from, to]: [f64; 2], _part: f64) -> Vec<f64> {
        self(from, to)
    }
}
