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

/// Energy W, force W′, stiffness W″ and W‴ at `x` beyond the point, of stiffness k over a width w. Up to −w/2, which is included, all are
/// zero.
pub(super) fn one_sided([k, w]: [f64; 2], x: f64) -> [f64; 4] {
    // A place that is no number stays none.
    if x <= -0.5 * w {
        return [0.0; 4];
    }
    if x < 0.5 * w {
        let t = x / w + 0.5;
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
    [0.5 * k * x * x + stored, k * x, k, 0.0]
}
