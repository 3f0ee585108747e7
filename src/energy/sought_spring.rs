//! Springs and dampers with constants that are arguments.

use crate::energy::along_span::of_invariants;
use crate::energy::{Affine, SoughtEnergy};
use crate::math::Jet;
use nalgebra::SVector;

/// Elastic energy `½ k (|r| − ℓ)²`, arguments: span r, parameters. Not finite for r = 0.
#[derive(Clone, Debug)]
pub struct SoughtSpring {
    /// Stiffness k in N/mm.
    pub stiffness: Affine,
    /// Length ℓ without force in mm.
    pub length: Affine,
}

impl<const M: usize> SoughtEnergy<M> for SoughtSpring {
    fn jet<const ORDER: usize>(&self, p: &SVector<f64, M>, w: &SVector<f64, M>) -> Jet<M, ORDER> {
        let extension = Jet::dot(0, 0, p, w).sqrt() - self.length.jet(p, w);
        extension.squared() * self.stiffness.jet(p, w) * 0.5
    }
}

/// Virtual work `−c (r·ṙ)(r·δr)/|r|²`, arguments: δr, r̄, ṙ, parameters. Not finite for r = 0.
#[derive(Clone, Debug)]
pub struct SoughtSpanDamper {
    /// Damping c in N ms/mm.
    pub coefficient: Affine,
}

impl<const M: usize> SoughtEnergy<M> for SoughtSpanDamper {
    const VIRTUAL: usize = 1;

    fn jet<const ORDER: usize>(&self, p: &SVector<f64, M>, w: &SVector<f64, M>) -> Jet<M, ORDER> {
        let work = of_invariants(p, w, |[alpha, beta, gamma]| alpha * beta * gamma.recip());
        work * self.coefficient.jet(p, w) * -1.0
    }
}
