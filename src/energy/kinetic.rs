//! Kinetic energy of a point mass.

use crate::energy::{Energy, OfSquare};
use crate::math::Number;
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
