//! Gravity.

use crate::energy::Energy;
use crate::math::{Jet, Number};
use nalgebra::{SVector, Vector3};

/// Potential energy `−m g·x` of a point mass, arguments `x`.
#[derive(Clone, Copy, Debug)]
pub struct Gravity<T = f64> {
    /// Weight `m g` in N.
    pub weight: Vector3<T>,
}

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
