//! Kinetic energies of masses.

use crate::energy::{Energy, OfSquare, law};
use crate::math::{Jet, Number};
use nalgebra::{SVector, Vector3};

/// Kinetic energy `½ m |v|²`, arguments: rate v.
#[derive(Clone, Copy, Debug)]
pub struct KineticEnergy<T = f64> {
    /// Mass m in g.
    pub mass: T,
}

law!(KineticEnergy { mass } of 3);

impl<T: Number> Energy<3, T> for KineticEnergy<T> {
    type Local<const ORDER: usize> = OfSquare<T>;

    const DEGREE: usize = 2;
    const KINETIC: bool = true;
    const ISOTROPIC: bool = true;

    fn at<const ORDER: usize>(&self, p: &SVector<T, 3>, w: &SVector<T, 3>) -> OfSquare<T> {
        let (half, none) = (self.mass.scaled(0.5), T::zero());
        let energy = |i| [half * i, half, none, none];
        OfSquare::new(p, w, T::one(), energy, |_| [none; 4])
    }
}

/// Kinetic energy `m v·w` of an entry of a mass matrix between two points, arguments: rates v and w.
#[derive(Clone, Copy, Debug)]
pub struct KineticCoupling<T = f64> {
    /// Mass m in g.
    pub mass: T,
}

law!(KineticCoupling { mass } of 6);

impl<T: Number> Energy<6, T> for KineticCoupling<T> {
    type Local<const ORDER: usize> = Jet<6, ORDER, T>;

    const DEGREE: usize = 2;
    const KINETIC: bool = true;

    fn at<const ORDER: usize>(&self, p: &SVector<T, 6>, w: &SVector<T, 6>) -> Jet<6, ORDER, T> {
        Jet::dot(0, 3, p, w) * self.mass
    }
}

/// Potential energy `−m g·x` of a point mass, arguments `x`.
#[derive(Clone, Copy, Debug)]
pub struct Gravity<T = f64> {
    /// Weight `m g` in N.
    pub weight: Vector3<T>,
}

law!(Gravity { weight } of 3);

impl<T: Number> Energy<3, T> for Gravity<T> {
    type Local<const ORDER: usize> = Jet<3, ORDER, T>;

    const DEGREE: usize = 1;

    fn at<const ORDER: usize>(&self, x: &SVector<T, 3>, w: &SVector<T, 3>) -> Jet<3, ORDER, T> {
        let mut jet = Jet::constant(-self.weight.dot(x));
        jet.gradient = -self.weight;
        jet.value_w = -self.weight.dot(w);
        jet
    }
}

/// Potential energy `−F w·x` of a load F that exerts the force F w, which does not turn, arguments: place x, load F.
///
/// With w = (1, 0, 0) it is that of a generalised force F on a coordinate, which stands in the first component of a vector.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DeadLoad<T = f64> {
    /// Force w of a load of one.
    pub force: Vector3<T>,
}

law!(DeadLoad { force } of 4);

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

law!(FollowingForce of 13);

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
