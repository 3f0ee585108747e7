//! Spring of a joint coordinate, and constraints that make an unknown the coordinate of a joint of directors.

use crate::energy::Energy;
use crate::math::{Jet, Number};
use nalgebra::SVector;

/// Elastic energy `½ k (u − u₀)²`, arguments: the coordinate u in the first component of a vector.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CoordinateSpring<T = f64> {
    /// Stiffness k in N mm/rad or N/mm.
    pub stiffness: T,
    /// Coordinate u₀ without force, in rad or mm.
    pub rest: T,
}

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
