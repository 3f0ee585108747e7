//! Kinetic energies of masses.

use crate::energy::{Energy, OfSquare};
use crate::math::{Jet, Number};
use nalgebra::SVector;

/// Kinetic energy `½ m |v|²`, arguments: rate v.
#[derive(Clone, Copy, Debug)]
pub struct KineticEnergy<T = f64> {
    /// Mass m in g.
    pub mass: T,
}

impl<T: Number> Energy<3, T> for KineticEnergy<T> {
    type Local<const ORDER: usize> = OfSquare<T>;

    const DEGREE: usize = 2;
    const ISOTROPIC: bool = true;

    fn at<const ORDER: usize>(&self, p: &SVector<T, 3>, w: &SVector<T, 3>) -> OfSquare<T> {
        let (half, none) = (self.mass.scaled(0.5), T::zero());
        let energy = |i| [half * i, half, none, none];
        OfSquare::new((p, w), T::one(), energy, |_| [none; 4])
    }
}

/// Kinetic energy `m v·w` of an entry of a mass matrix between two points, arguments: rates v and w.
#[derive(Clone, Copy, Debug)]
pub struct KineticCoupling<T = f64> {
    /// Mass m in g.
    pub mass: T,
}

impl<T: Number> Energy<6, T> for KineticCoupling<T> {
    type Local<const ORDER: usize> = Jet<6, ORDER, T>;

    const DEGREE: usize = 2;

    fn at<const ORDER: usize>(&self, p: &SVector<T, 6>, w: &SVector<T, 6>) -> Jet<6, ORDER, T> {
        Jet::dot(0, 3, p, w) * self.mass
    }
}
