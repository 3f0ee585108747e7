//! Viscosity of the lumped muscle as virtual work.

use crate::energy::{AlongSpan, Energy};
use crate::math::{Jet, Number};
use nalgebra::SVector;

/// Virtual work `−(3/2) η V₀ (r·ṙ)(r·δr)/|r|⁴` of σ_vis = η d, arguments: δr, r̄, ṙ (docs/theory.md, 3.2).
///
/// At the midpoint r̄·ṙ is exactly the difference quotient of ½|r|², so the discrete force is objective.
#[derive(Clone, Copy, Debug)]
pub struct ViscousCell<T = f64> {
    /// (3/2) η V₀ in N mm ms.
    pub coefficient: T,
}

/// Force `c (r̄·ṙ)/|r̄|³` along the span of a [`ViscousCell`] with the coefficient c, arguments: r̄ and ṙ. Positive where the span grows.
#[derive(Clone, Copy, Debug)]
pub struct ViscousTension<T = f64>(pub ViscousCell<T>);

impl<T: Number> Energy<6, T> for ViscousTension<T> {
    type Local<const ORDER: usize> = Jet<6, ORDER, T>;

    const READINGS: usize = 2;

    fn at<const ORDER: usize>(&self, p: &SVector<T, 6>, w: &SVector<T, 6>) -> Jet<6, ORDER, T> {
        let inverse = Jet::dot(0, 0, p, w).recip();
        let factor = inverse * inverse.sqrt() * self.0.coefficient;
        Jet::dot(0, 3, p, w) * factor
    }
}

impl<T: Number> Energy<9, T> for ViscousCell<T> {
    type Local<const ORDER: usize> = AlongSpan<T>;

    const READINGS: usize = 3;
    const VIRTUAL: usize = 1;

    fn couples(i: usize, j: usize) -> bool {
        AlongSpan::<T>::couples(i, j)
    }

    #[inline(always)]
    fn at<const ORDER: usize>(&self, p: &SVector<T, 9>, _: &SVector<T, 9>) -> AlongSpan<T> {
        AlongSpan::new(p, |gamma| {
            let r = gamma.recip();
            let k = -self.coefficient * r * r;
            [k, k.scaled(-2.0) * r, k.scaled(6.0) * r * r]
        })
    }
}
