//! A tendon: an elastic cable that slides without friction through any number of points, and takes no compression.
//!
//! Its energy `½ k max(L − ℓ, 0)²` has a stiffness that jumps at ℓ, or grows over a width around it (see `one_sided`).

use crate::energy::one_sided::one_sided;
use crate::math::Number;

/// Elastic energy of the length L of a path of spans.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cable<T = f64> {
    /// Stiffness k in N/mm.
    pub stiffness: T,
    /// Length ℓ without force in mm.
    pub length: T,
    /// Width w in mm over which the stiffness grows; zero where it jumps.
    pub smoothing: f64,
}

impl<T: Number> Cable<T> {
    /// Energy W, tension W′, stiffness W″ and W‴ at a length. Slack is the left of ℓ − w/2, ℓ − w/2 included.
    pub fn of_length(&self, length: T) -> [T; 4] {
        let beyond = length - self.length;
        one_sided((self.stiffness, self.smoothing), beyond)
    }
}
