//! Loads: forces and charges whose size is an input.

use crate::energy::Energy;
use crate::math::{Jet, Number};
use nalgebra::{SVector, Vector3};

/// Potential energy `−F w·x` of a load F that exerts the force F w, which does not turn, arguments: place x, load F.
///
/// With w = (1, 0, 0) it is that of a generalised force F on a coordinate, which stands in the first component of a vector.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DeadLoad<T = f64> {
    /// Force w of a load of one.
    pub force: Vector3<T>,
}

impl<T: Number> Energy<4, T> for DeadLoad<T> {
    type Local<const ORDER: usize> = Jet<4, ORDER, T>;

    const DEGREE: usize = 2;

    fn couples(_: usize, _: usize) -> bool {
        false
    }

    fn at<const ORDER: usize>(&self, p: &SVector<T, 4>, w: &SVector<T, 4>) -> Jet<4, ORDER, T> {
        let component = |i: usize| Jet::argument(i, p, w) * -self.force[i];
        (component(0) + component(1) + component(2)) * Jet::argument(3, p, w)
    }
}

/// Virtual work `F δx·d` of a force F along a direction d that turns with the body, arguments: δx, δd, x, d, force F.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FollowingForce;

impl<T: Number> Energy<13, T> for FollowingForce {
    type Local<const ORDER: usize> = Jet<13, ORDER, T>;

    const DEGREE: usize = 3;
    const VIRTUAL: usize = 2;
    const READINGS: usize = 2;
    const APPLIED: bool = true;

    fn couples(i: usize, j: usize) -> bool {
        matches!((i, j), (0, 3) | (3, 0))
    }

    fn at<const ORDER: usize>(&self, p: &SVector<T, 13>, w: &SVector<T, 13>) -> Jet<13, ORDER, T> {
        Jet::dot(0, 9, p, w) * Jet::argument(12, p, w)
    }
}

/// Potential energy `Q φ A` of a charge Q for an area on an area A of potential φ, arguments: φ in its unit, Q.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfaceCharge {
    /// Area A in mm², times the unit of the potential in V.
    pub weight: f64,
}

impl Energy<2> for SurfaceCharge {
    type Local<const ORDER: usize> = Jet<2, ORDER>;

    const DEGREE: usize = 2;

    fn at<const ORDER: usize>(&self, p: &SVector<f64, 2>, w: &SVector<f64, 2>) -> Jet<2, ORDER> {
        Jet::argument(0, p, w) * Jet::argument(1, p, w) * self.weight
    }
}
