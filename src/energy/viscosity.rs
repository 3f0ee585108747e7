//! Viscosity of the lumped muscle as virtual work.

use crate::energy::{AlongSpan, Energy};
use crate::math::Jet;
use nalgebra::SVector;

/// Virtual work `−(3/2) η V₀ (r·ṙ)(r·δr)/|r|⁴` of σ_vis = η d, arguments: δr, r̄, ṙ (docs/theory.md, 3.2).
///
/// At the midpoint r̄·ṙ is exactly the difference quotient of ½|r|², so the discrete force is objective.
#[derive(Clone, Copy, Debug)]
pub struct ViscousCell {
    /// (3/2) η V₀ in N mm ms.
    pub coefficient: f64,
}

/// Force `c (r̄·ṙ)/|r̄|³` along the span of a [`ViscousCell`] with the coefficient c, arguments: r̄ and ṙ. Positive where the span grows.
#[derive(Clone, Copy, Debug)]
pub struct ViscousTension(pub ViscousCell);

impl Energy<6> for ViscousTension {
    type Local<const ORDER: usize> = Jet<6, ORDER>;

    const READINGS: usize = 2;

    fn at<const ORDER: usize>(&self, p: &SVector<f64, 6>, w: &SVector<f64, 6>) -> Jet<6, ORDER> {
        let inverse = Jet::dot(0, 0, p, w).recip();
        let factor = inverse * inverse.sqrt() * self.0.coefficient;
        Jet::dot(0, 3, p, w) * factor
    }
}

impl Energy<9> for ViscousCell {
    type Local<const ORDER: usize> = AlongSpan;

    const READINGS: usize = 3;
    const VIRTUAL: usize = 1;

    fn couples(i: usize, j: usize) -> bool {
        AlongSpan::couples(i, j)
    }

    #[inline(always)]
    fn at<const ORDER: usize>(&self, p: &SVector<f64, 9>, _: &SVector<f64, 9>) -> AlongSpan {
        AlongSpan::new(p, |gamma| {
            let r = 1.0 / gamma;
            let k = -self.coefficient * r * r;
            [k, -2.0 * k * r, 6.0 * k * r * r]
        })
    }
}
