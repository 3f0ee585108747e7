//! One-sided elasticity: no force up to a point, and from there on that of a spring.
//!
//! The energy `½ k max(x, 0)²` has a stiffness that jumps at zero. Over a width w around it the stiffness may grow as a polynomial of
//! t = x/w + ½ from zero at t = 0 to k at t = 1, so that the energy has three continuous derivatives:
//!
//! ```text
//! W″ = k (3t² − 2t³),   W′ = k w (t³ − t⁴/2),   W = k w² (t⁴/4 − t⁵/10).
//! ```
//!
//! Beyond, the force is k x as without a width.
//!
//! A tendon: an elastic cable that slides without friction through any number of points, and takes no compression.
//!
//! Its energy `½ k max(L − ℓ, 0)²` has a stiffness that jumps at ℓ, or grows over a width around it (see `one_sided`).

use crate::energy::Energy;
use crate::math::{Jet, Number};
use nalgebra::SVector;

/// Energy W, force W′, stiffness W″ and W‴ at `x` beyond the point, of stiffness k over a width w. Up to −w/2, which is included, all are
/// zero.
pub(super) fn one_sided<T: Number>(k: T, w: f64, x: T) -> [T; 4] {
    // A place that is no number stays none.
    if x.real() <= -0.5 * w {
        return [T::zero(); 4];
    }
    if x.real() < 0.5 * w {
        let t = (x.over(T::of(w))).shifted(0.5);
        let [t2, t3] = [t * t, t * t * t];
        let quadratic = t2.scaled(0.1);
        return [
            k.scaled(w).scaled(w) * t3 * (t.scaled(0.25) - quadratic),
            k.scaled(w) * t3 * (T::one() - t.scaled(0.5)),
            k * (t2.scaled(3.0) - t3.scaled(2.0)),
            k.over(T::of(w)) * (t.scaled(6.0) - t2.scaled(6.0)),
        ];
    }
    // What the growth of the stiffness has stored more.
    let stored = k.scaled(0.025).scaled(w).scaled(w);
    [k.scaled(0.5) * x * x + stored, k * x, k, T::zero()]
}

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
        let of = |beyond| one_sided(self.stiffness, self.smoothing, beyond);
        let (above, below) = (of(p[0] - self.at[1]), of(self.at[0] - p[0]));
        let signs = [1.0, -1.0, 1.0, -1.0];
        Jet::argument(0, p, w).map(std::array::from_fn(|d| above[d] + signs[d] * below[d]))
    }
}

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
        one_sided(self.stiffness, self.smoothing, beyond)
    }
}
