//! A tendon: an elastic cable that slides without friction through any number of points, and takes no compression.
//!
//! Its energy `½ k max(L − ℓ, 0)²` has a stiffness that jumps at ℓ. Over a width w around ℓ the stiffness may grow as a polynomial of
//! t = (L − ℓ)/w + ½ from zero at t = 0 to k at t = 1, so that the energy has three continuous derivatives:
//!
//! ```text
//! W″ = k (3t² − 2t³),   W′ = k w (t³ − t⁴/2),   W = k w² (t⁴/4 − t⁵/10).
//! ```
//!
//! Beyond, the tension is k (L − ℓ) as without a width.

/// Elastic energy of the length L of a path of spans.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cable {
    /// Stiffness k in N/mm.
    pub stiffness: f64,
    /// Length ℓ without force in mm.
    pub length: f64,
    /// Width w in mm over which the stiffness grows; zero where it jumps.
    pub smoothing: f64,
}

impl Cable {
    /// Energy W, tension W′, stiffness W″ and W‴ at a length. Slack is the left of ℓ − w/2, ℓ − w/2 included.
    pub fn of_length(&self, length: f64) -> [f64; 4] {
        let (k, w) = (self.stiffness, self.smoothing);
        let beyond = length - self.length;
        // A length that is no number stays none.
        if beyond <= -0.5 * w {
            return [0.0; 4];
        }
        if beyond < 0.5 * w {
            let t = beyond / w + 0.5;
            let [t2, t3] = [t * t, t * t * t];
            return [
                k * w * w * t3 * (0.25 * t - 0.1 * t2),
                k * w * t3 * (1.0 - 0.5 * t),
                k * (3.0 * t2 - 2.0 * t3),
                k / w * (6.0 * t - 6.0 * t2),
            ];
        }
        // What the growth of the stiffness has stored more.
        let stored = 0.025 * k * w * w;
        [0.5 * k * beyond * beyond + stored, k * beyond, k, 0.0]
    }
}
