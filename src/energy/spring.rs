//! A spring and a damper between two points.

use crate::energy::Energy;
use crate::energy::viscosity::of_invariants;
use crate::math::Jet;
use nalgebra::SVector;

/// Elastic energy `½ k (|r| − ℓ)²`, arguments: span r. Not finite for r = 0 unless ℓ = 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LinearSpring {
    /// Stiffness k in N/mm.
    pub stiffness: f64,
    /// Length ℓ without force in mm.
    pub length: f64,
}

impl LinearSpring {
    /// ½ k (√I − ℓ)² as a function of I = |r|²: value and three derivatives.
    #[inline]
    fn of_squared_length(&self, i: f64) -> [f64; 4] {
        let (k, l) = (self.stiffness, self.length);
        if l == 0.0 {
            return [0.5 * k * i, 0.5 * k, 0.0, 0.0];
        }
        let s = i.sqrt();
        let r = 1.0 / i;
        let q = k * l * r / s;
        [
            0.5 * k * (s - l) * (s - l),
            0.5 * k * (1.0 - l / s),
            0.25 * q,
            -0.375 * q * r,
        ]
    }
}

impl Energy<3> for LinearSpring {
    #[inline]
    fn jet<const ORDER: usize>(&self, p: &SVector<f64, 3>, w: &SVector<f64, 3>) -> Jet<3, ORDER> {
        let i = Jet::dot(0, 0, p, w);
        i.map(self.of_squared_length(i.value))
    }
}

/// Virtual work `−c (r·ṙ)(r·δr)/|r|²` of a force c d|r|/dt along the span, arguments: δr, r̄, ṙ. Not finite for r = 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpanDamper {
    /// Damping c in N ms/mm.
    pub coefficient: f64,
}

impl Energy<9> for SpanDamper {
    const VIRTUAL: usize = 1;

    #[inline]
    fn jet<const ORDER: usize>(&self, p: &SVector<f64, 9>, w: &SVector<f64, 9>) -> Jet<9, ORDER> {
        of_invariants(p, w, |[alpha, beta, gamma]| {
            alpha * beta * gamma.recip() * -self.coefficient
        })
    }
}
