//! Viscosity of the lumped muscle as virtual work.

use crate::energy::Energy;
use crate::math::Jet;
use nalgebra::SVector;

/// Virtual work `−(3/2) η V₀ (r·ṙ)(r·δr)/|r|⁴` of σ_vis = η d, arguments: δr, r̄, ṙ (physics.md, 3.2).
///
/// At the midpoint r̄·ṙ is exactly the difference quotient of ½|r|², so the discrete force is objective.
#[derive(Clone, Copy, Debug)]
pub struct ViscousCell {
    /// (3/2) η V₀ in N mm ms.
    pub coefficient: f64,
}

impl Energy<9> for ViscousCell {
    const VIRTUAL: usize = 1;

    #[inline]
    fn jet<const ORDER: usize>(&self, p: &SVector<f64, 9>, w: &SVector<f64, 9>) -> Jet<9, ORDER> {
        let alpha = Jet::dot(3, 6, p, w);
        let beta = Jet::dot(3, 0, p, w);
        let gamma = Jet::dot(3, 3, p, w);
        let q = SVector::from([alpha.value, beta.value, gamma.value]);
        let rates = SVector::from([alpha.value_w, beta.value_w, gamma.value_w]);
        let argument = |i| Jet::<3, ORDER>::argument(i, &q, &rates);
        let outer = argument(0) * argument(1) * argument(2).squared().recip() * -self.coefficient;
        Jet::compose(&outer, &[alpha, beta, gamma])
    }
}
