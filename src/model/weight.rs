//! Weights and kinetic energies of masses, some of which are free.

use crate::energy::{Gravity, KineticCoupling, KineticEnergy, Polynomial};
use crate::functional::Law;
use crate::math::Number;
use nalgebra::Vector3;

/// Weight of a mass m in g under a gravity g in mm/ms².
#[derive(Clone)]
pub(super) struct Weight {
    pub(super) mass: Polynomial,
    pub(super) gravity: [Polynomial; 3],
}

impl Law<3> for Weight {
    type Formula<T: Number> = Gravity<T>;

    fn formula<T: Number>(&self, parameters: &[T]) -> Gravity<T> {
        let mass = self.mass.at(parameters);
        let [x, y, z] = self.gravity.each_ref().map(|g| g.at(parameters) * mass);
        Gravity {
            weight: Vector3::new(x, y, z),
        }
    }
}

/// Kinetic energy of a mass in g.
#[derive(Clone)]
pub(super) struct Moving(pub(super) Polynomial);

impl Law<3> for Moving {
    type Formula<T: Number> = KineticEnergy<T>;

    fn formula<T: Number>(&self, parameters: &[T]) -> KineticEnergy<T> {
        KineticEnergy {
            mass: self.0.at(parameters),
        }
    }
}

/// Kinetic energy of an entry of a mass matrix in g between two points.
#[derive(Clone)]
pub(super) struct MovingTogether(pub(super) Polynomial);

impl Law<6> for MovingTogether {
    type Formula<T: Number> = KineticCoupling<T>;

    fn formula<T: Number>(&self, parameters: &[T]) -> KineticCoupling<T> {
        KineticCoupling {
            mass: self.0.at(parameters),
        }
    }
}
