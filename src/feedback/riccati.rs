//! One step of the Riccati recursion of the linear-quadratic regulator, backward in time.
//!
//! Of `x₊ = A x + B u` with the cost `xᵀQx + uᵀRu` of a step and `xᵀS₊x` of what follows, the best input is `u = −K x`, and
//!
//! ```text
//! K = (R + BᵀS₊B)⁻¹ BᵀS₊A,     S = Q + KᵀRK + (A − BK)ᵀ S₊ (A − BK)
//! ```
//!
//! The same recursion of `(Aᵀ, Cᵀ)` with the covariances of noise is that of the Kalman filter, forward in time.

use nalgebra::DMatrix;

/// Costs of a step: Q of the state, R of the input; both symmetric.
#[derive(Clone, Debug, PartialEq)]
pub struct Costs {
    /// Q, positive semidefinite.
    pub state: DMatrix<f64>,
    /// R, positive definite.
    pub inputs: DMatrix<f64>,
}

/// Gain K and cost S of a step.
#[derive(Clone, Debug, PartialEq)]
pub struct RiccatiStep {
    /// K.
    pub gain: DMatrix<f64>,
    /// S.
    pub cost: DMatrix<f64>,
}

/// The step before one with the cost `after`; `None` where R + BᵀSB is not positive definite, or the result not finite.
pub fn riccati_step(
    [a, b]: [&DMatrix<f64>; 2],
    costs: &Costs,
    after: &DMatrix<f64>,
) -> Option<RiccatiStep> {
    let toward = b.transpose() * after;
    let inner = symmetric(&costs.inputs + &toward * b);
    let gain = inner.cholesky()?.solve(&(toward * a));
    let closed = a - b * &gain;
    let cost = symmetric(
        &costs.state
            + gain.transpose() * &costs.inputs * &gain
            + closed.transpose() * after * &closed,
    );
    let is_finite = cost.iter().chain(&gain).all(|value| value.is_finite());
    is_finite.then_some(RiccatiStep { gain, cost })
}

/// The symmetric part of a matrix.
pub(crate) fn symmetric(matrix: DMatrix<f64>) -> DMatrix<f64> {
    0.5 * (&matrix + matrix.transpose())
}
