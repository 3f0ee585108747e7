//! A spring and a damper between two points.

use crate::energy::{AlongSpan, Energy, OfSquare};
use crate::math::Number;
use nalgebra::SVector;

/// Elastic energy `½ k (|r| − ℓ)²`, arguments: span r. Not finite for r = 0 unless ℓ = 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LinearSpring<T = f64> {
    /// Stiffness k in N/mm.
    pub stiffness: T,
    /// Length ℓ without force in mm.
    pub length: T,
}

impl<T: Number> LinearSpring<T> {
    /// ½ k (√I − ℓ)² as a function of I = |r|²: value and three derivatives.
    #[inline(always)]
    fn of_squared_length(&self, i: T) -> [T; 4] {
        let (k, l) = (self.stiffness, self.length);
        if l == T::zero() {
            return [k.scaled(0.5) * i, k.scaled(0.5), T::zero(), T::zero()];
        }
        let s = i.sqrt();
        let r = i.recip();
        let q = (k * l * r).over(s);
        [
            k.scaled(0.5) * (s - l) * (s - l),
            k.scaled(0.5) * (T::one() - l.over(s)),
            q.scaled(0.25),
            q.scaled(-0.375) * r,
        ]
    }
}

impl<T: Number> Energy<3, T> for LinearSpring<T> {
    type Local<const ORDER: usize> = OfSquare<T>;

    #[inline(always)]
    fn at<const ORDER: usize>(&self, p: &SVector<T, 3>, w: &SVector<T, 3>) -> OfSquare<T> {
        let none = |_| [T::zero(); 4];
        OfSquare::new((p, w), T::one(), |i| self.of_squared_length(i), none)
    }
}

/// Virtual work `−c (r·ṙ)(r·δr)/|r|²` of a force c d|r|/dt along the span, arguments: δr, r̄, ṙ. Not finite for r = 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpanDamper<T = f64> {
    /// Damping c in N ms/mm.
    pub coefficient: T,
}

impl<T: Number> Energy<9, T> for SpanDamper<T> {
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
            let k = -self.coefficient * r;
            [k, -k * r, k.scaled(2.0) * r * r]
        })
    }
}
