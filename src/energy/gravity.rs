//! Gravity.

use crate::energy::Energy;
use crate::math::{Jet, Vector};
use nalgebra::SVector;

/// Potential energy `−m g·x` of a point mass, arguments `x`.
#[derive(Clone, Copy, Debug)]
pub struct Gravity {
    /// Weight `m g` in N.
    pub weight: Vector,
}

impl Energy<3> for Gravity {
    type Local<const ORDER: usize> = Jet<3, ORDER>;

    const DEGREE: usize = 1;

    fn at<const ORDER: usize>(&self, x: &SVector<f64, 3>, w: &SVector<f64, 3>) -> Jet<3, ORDER> {
        let mut jet = Jet::constant(-self.weight.dot(x));
        jet.gradient = -self.weight;
        jet.value_w = -self.weight.dot(w);
        jet
    }
}
