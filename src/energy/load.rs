//! Loads: forces whose size is an input.

use crate::energy::Energy;
use crate::math::{Jet, Vector};
use nalgebra::SVector;

/// Potential energy `−F e·x` of a force F along a direction e that does not turn, arguments: place x, force F.
///
/// With e = (1, 0, 0) it is that of a generalised force F on a coordinate, which stands in the first component of a vector.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DeadLoad {
    /// Direction e, of length one.
    pub direction: Vector,
}

impl Energy<4> for DeadLoad {
    type Local<const ORDER: usize> = Jet<4, ORDER>;

    const DEGREE: usize = 2;

    fn couples(_: usize, _: usize) -> bool {
        false
    }

    fn at<const ORDER: usize>(&self, p: &SVector<f64, 4>, w: &SVector<f64, 4>) -> Jet<4, ORDER> {
        let component = |i: usize| Jet::argument(i, p, w) * -self.direction[i];
        (component(0) + component(1) + component(2)) * Jet::argument(3, p, w)
    }
}
