//! A spring and a damper between two points.

use crate::energy::{AlongSpan, Energy, OfSquare, law};
use crate::math::{Jet, Number};
use nalgebra::SVector;

/// Elastic energy `½ k (|r| − ℓ)²`, arguments: span r. Not finite for r = 0 unless ℓ = 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LinearSpring<T = f64> {
    /// Stiffness k in N/mm.
    pub stiffness: T,
    /// Length ℓ without force in mm.
    pub length: T,
}

law!(LinearSpring { stiffness, length } of 3);

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
        OfSquare::new(p, w, T::one(), |i| self.of_squared_length(i), none)
    }
}

/// Virtual work `−c (r·ṙ)(r·δr)/|r|²` of a force c d|r|/dt along the span, arguments: δr, r̄, ṙ. Not finite for r = 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpanDamper<T = f64> {
    /// Damping c in N ms/mm.
    pub coefficient: T,
}

law!(SpanDamper { coefficient } of 9);

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

/// Elastic energy `½ k (u − u₀)²`, arguments: the coordinate u in the first component of a vector.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CoordinateSpring<T = f64> {
    /// Stiffness k in N mm/rad or N/mm.
    pub stiffness: T,
    /// Coordinate u₀ without force, in rad or mm.
    pub rest: T,
}

law!(CoordinateSpring { stiffness, rest } of 3);

impl<T: Number> Energy<3, T> for CoordinateSpring<T> {
    type Local<const ORDER: usize> = Jet<3, ORDER, T>;

    const DEGREE: usize = 2;

    fn at<const ORDER: usize>(&self, p: &SVector<T, 3>, w: &SVector<T, 3>) -> Jet<3, ORDER, T> {
        (Jet::argument(0, p, w) + -self.rest).squared() * self.stiffness.scaled(0.5)
    }
}

/// `λ ((b·c) cos θ − (a·c) sin θ)`, arguments: vectors a, b of the parent and c of the child of a revolute joint, its angle θ in the
/// first component of a vector, multiplier λ. The constraint is sin(φ − θ) for the angle φ of the vectors: θ counts whole turns.
#[derive(Clone, Copy, Debug)]
pub struct JointAngle;

impl Energy<13> for JointAngle {
    type Local<const ORDER: usize> = Jet<13, ORDER>;

    fn couples(i: usize, j: usize) -> bool {
        // Neither a nor b meets itself or the other one, and c does not meet itself.
        (i, j) == (3, 3) || i != j && (i.min(j), i.max(j)) != (0, 1)
    }

    fn at<const ORDER: usize>(&self, p: &SVector<f64, 13>, w: &SVector<f64, 13>) -> Jet<13, ORDER> {
        let angle = Jet::argument(9, p, w);
        let (sin, cos) = p[9].sin_cos();
        let across = Jet::dot(3, 6, p, w) * angle.map([cos, -sin, -cos, sin]);
        let along = Jet::dot(0, 6, p, w) * angle.map([sin, cos, -sin, -cos]);
        (across - along) * Jet::argument(12, p, w)
    }
}

/// `λ (n·r − y)`, arguments: axis n and span r of a prismatic joint, its displacement y in the first component of a vector,
/// multiplier λ.
#[derive(Clone, Copy, Debug)]
pub struct JointDisplacement;

impl Energy<10> for JointDisplacement {
    type Local<const ORDER: usize> = Jet<10, ORDER>;

    const DEGREE: usize = 3;

    fn couples(i: usize, j: usize) -> bool {
        (i.min(j), i.max(j)) == (0, 1)
    }

    fn at<const ORDER: usize>(&self, p: &SVector<f64, 10>, w: &SVector<f64, 10>) -> Jet<10, ORDER> {
        (Jet::dot(0, 3, p, w) - Jet::argument(6, p, w)) * Jet::argument(9, p, w)
    }
}
