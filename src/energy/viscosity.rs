//! Viscosity of the lumped muscle as virtual work.

use crate::energy::Energy;
use crate::math::{Jet, Matrix, Vector};
use nalgebra::SVector;

/// Virtual work `−(3/2) η V₀ (r·ṙ)(r·δr)/|r|⁴` of σ_vis = η d, arguments: δr, r̄, ṙ (docs/theory.md, 3.2).
///
/// At the midpoint r̄·ṙ is exactly the difference quotient of ½|r|², so the discrete force is objective.
#[derive(Clone, Copy, Debug)]
pub struct ViscousCell {
    /// (3/2) η V₀ in N mm ms.
    pub coefficient: f64,
}

/// A function of the invariants α = r̄·ṙ, β = r̄·δr, γ = |r̄|² of the first arguments δr, r̄, ṙ.
pub(super) fn of_invariants<const M: usize, const ORDER: usize>(
    p: &SVector<f64, M>,
    w: &SVector<f64, M>,
    outer: impl FnOnce([Jet<3, ORDER>; 3]) -> Jet<3, ORDER>,
) -> Jet<M, ORDER> {
    let inner = [
        Jet::dot(3, 6, p, w),
        Jet::dot(3, 0, p, w),
        Jet::dot(3, 3, p, w),
    ];
    let values = SVector::from(inner.map(|j| j.value));
    let rates = SVector::from(inner.map(|j| j.value_w));
    let arguments = std::array::from_fn(|i| Jet::argument(i, &values, &rates));
    Jet::compose(&outer(arguments), &inner)
}

/// To second order, all that a virtual work is asked for in a sum, the jet is written out: W = k α β/γ² is linear in α
/// and β, and a general jet of nine arguments costs several times more.
impl Energy<9> for ViscousCell {
    const VIRTUAL: usize = 1;

    #[inline]
    fn jet<const ORDER: usize>(&self, p: &SVector<f64, 9>, w: &SVector<f64, 9>) -> Jet<9, ORDER> {
        if ORDER >= 3 {
            return of_invariants(p, w, |[alpha, beta, gamma]| {
                alpha * beta * gamma.squared().recip() * -self.coefficient
            });
        }
        let part = |i: usize| Vector::new(p[i], p[i + 1], p[i + 2]);
        let (d, r, v) = (part(0), part(3), part(6));
        let (alpha, beta, inverse) = (r.dot(&v), r.dot(&d), 1.0 / r.norm_squared());
        let k = -self.coefficient * inverse * inverse;
        let (wa, wb, wc) = (k * beta, k * alpha, -2.0 * k * alpha * beta * inverse);
        let mut jet = Jet::<9, ORDER>::constant(k * alpha * beta);
        jet.gradient.fixed_rows_mut::<3>(0).copy_from(&(r * wb));
        jet.gradient
            .fixed_rows_mut::<3>(3)
            .copy_from(&(v * wa + d * wb + r * (2.0 * wc)));
        jet.gradient.fixed_rows_mut::<3>(6).copy_from(&(r * wa));
        if ORDER >= 2 {
            let (wac, wbc) = (-2.0 * k * beta * inverse, -2.0 * k * alpha * inverse);
            let wcc = -3.0 * wc * inverse;
            // Gradients of W_α, W_β, W_γ by r̄.
            let ga = d * k + r * (2.0 * wac);
            let gb = v * k + r * (2.0 * wbc);
            let gc = v * wac + d * wbc + r * (2.0 * wcc);
            let one = Matrix::identity();
            let rr = r * r.transpose();
            let dr = one * wb + r * gb.transpose();
            let dv = rr * k;
            let rv = one * wa + d * (r * k).transpose() + rr * (2.0 * wac);
            let second = one * (2.0 * wc)
                + v * ga.transpose()
                + d * gb.transpose()
                + r * (gc * 2.0).transpose();
            let mut set = |i: usize, j: usize, block: &Matrix| {
                jet.hessian.fixed_view_mut::<3, 3>(i, j).copy_from(block);
                jet.hessian
                    .fixed_view_mut::<3, 3>(j, i)
                    .copy_from(&block.transpose());
            };
            set(0, 3, &dr);
            set(0, 6, &dv);
            set(3, 6, &rv);
            set(3, 3, &second);
        }
        jet
    }
}
