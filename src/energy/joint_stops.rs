//! Stops of a joint coordinate.

use crate::energy::Energy;
use crate::energy::one_sided::one_sided;
use crate::math::Jet;
use nalgebra::SVector;

/// Elastic energy `½ k max(u − u₊, 0)² + ½ k max(u₋ − u, 0)²` of the stops of a joint, with or without a width over which the stiffness
/// grows; arguments: the coordinate u in the first component of a vector.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CoordinateStops {
    /// Stiffness k in N mm/rad or N/mm.
    pub stiffness: f64,
    /// Coordinates u₋ and u₊ of the stops in rad or mm; infinite where there is none.
    pub at: [f64; 2],
    /// Width w in rad or mm over which the stiffness grows; zero where it jumps.
    pub smoothing: f64,
}

impl Energy<3> for CoordinateStops {
    type Local<const ORDER: usize> = Jet<3, ORDER>;

    fn at<const ORDER: usize>(&self, p: &SVector<f64, 3>, w: &SVector<f64, 3>) -> Jet<3, ORDER> {
        let law = (self.stiffness, self.smoothing);
        let above = one_sided(law, p[0] - self.at[1]);
        let below = one_sided(law, self.at[0] - p[0]);
        let signs = [1.0, -1.0, 1.0, -1.0];
        Jet::argument(0, p, w).map(std::array::from_fn(|d| above[d] + signs[d] * below[d]))
    }
}
