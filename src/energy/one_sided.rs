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

use crate::math::Number;

/// Energy W, force W′, stiffness W″ and W‴ at `x` beyond the point, of stiffness k over a width w. Up to −w/2, which is included, all are
/// zero.
pub(super) fn one_sided<T: Number>((k, w): (T, f64), x: T) -> [T; 4] {
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
