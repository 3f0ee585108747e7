//! The gain that holds a state for ever: the discrete algebraic Riccati equation, by structure-preserving doubling.
//!
//! Each doubling of `A, G = B R⁻¹ Bᵀ, H = Q` leads to the same equation over twice as many steps,
//!
//! ```text
//! A ← A W A,     G ← G + A W G Aᵀ,     H ← H + Aᵀ H W A,     W = (1 + G H)⁻¹
//! ```
//!
//! so that H converges to the cost quadratically (Chu, Fan, Lin and Wang, Int. J. Control 77, 2004). Steps of the recursion then remove
//! rounding, and what they still change is the residual.
//!
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

/// Doublings that are tried: 2⁵⁰ steps.
const DOUBLINGS: usize = 50;
/// A change of the cost relative to it that counts as none.
const SMALL: f64 = 1e-13;
/// Steps of the recursion after the doublings.
const POLISHED: usize = 4;
/// A relative residual up to which the equation counts as solved.
const RESIDUAL: f64 = 1e-8;

/// The gain that holds a state, with its proof.
#[derive(Clone, Debug, PartialEq)]
pub struct HeldGain {
    /// K.
    pub gain: DMatrix<f64>,
    /// Cost S of the time that follows.
    pub cost: DMatrix<f64>,
    /// Relative residual of the Riccati equation.
    pub residual: f64,
    /// Spectral radius of A − BK, below one.
    pub radius: f64,
    /// That of A, without feedback.
    pub open_radius: f64,
}

/// Reason why no gain holds a state.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum NotHeld {
    /// The equation has no finite solution that was found: some motion that costs cannot be steered.
    Unsolved,
    /// The closed loop has this spectral radius of one or more: some motion is neither steered nor costs anything.
    Unstable(f64),
}

/// The gain that holds a state in which every step is the same.
///
/// # Errors
/// There is none, or it does not bring the state back.
pub fn held_gain([a, b]: [&DMatrix<f64>; 2], costs: &Costs) -> Result<HeldGain, NotHeld> {
    let open_radius = spectral_radius(a);
    let mut cost = doubled([a, b], costs).ok_or(NotHeld::Unsolved)?;
    let (mut residual, mut gain) = (f64::INFINITY, None);
    for _ in 0..POLISHED {
        let step = riccati_step([a, b], costs, &cost).ok_or(NotHeld::Unsolved)?;
        residual = (&step.cost - &cost).norm() / step.cost.norm().max(f64::MIN_POSITIVE);
        (cost, gain) = (step.cost, Some(step.gain));
    }
    let gain = gain.filter(|_| residual < RESIDUAL);
    let gain = gain.ok_or(NotHeld::Unsolved)?;
    let radius = spectral_radius(&(a - b * &gain));
    if radius.is_nan() || radius >= 1.0 {
        return Err(NotHeld::Unstable(radius));
    }
    Ok(HeldGain {
        gain,
        cost,
        residual,
        radius,
        open_radius,
    })
}

/// The limit of the doublings.
fn doubled([a, b]: [&DMatrix<f64>; 2], costs: &Costs) -> Option<DMatrix<f64>> {
    let n = a.nrows();
    let one = DMatrix::identity(n, n);
    let inverse = costs.inputs.clone().cholesky()?;
    let mut g = symmetric(b * inverse.solve(&b.transpose()));
    let (mut a, mut h) = (a.clone(), costs.state.clone());
    for _ in 0..DOUBLINGS {
        let w = (&one + &g * &h).lu();
        let (wa, wg) = (w.solve(&a)?, w.solve(&g)?);
        let next = symmetric(&h + a.transpose() * &h * &wa);
        g = symmetric(&g + &a * wg * a.transpose());
        let change = (&next - &h).norm();
        (a, h) = (&a * wa, next);
        let is_finite = h.iter().chain(&g).all(|value| value.is_finite());
        if !is_finite {
            return None;
        }
        if change <= SMALL * h.norm() {
            return Some(h);
        }
    }
    None
}

/// Squares that are taken: m = 2⁴⁰.
const SQUARES: i32 = 40;

/// The greatest modulus of the eigenvalues; NaN where the matrix is not finite.
pub fn spectral_radius(matrix: &DMatrix<f64>) -> f64 {
    let mut power = matrix.clone();
    // log |Aᵐ|^(1/m)
    let mut logarithm = 0.0;
    for square in 0..=SQUARES {
        let size = power.norm();
        if size == 0.0 || !size.is_finite() {
            return if size == 0.0 { 0.0 } else { f64::NAN };
        }
        logarithm += size.ln() * 0.5_f64.powi(square);
        power /= size;
        power = &power * &power;
    }
    logarithm.exp()
}

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

/// A row of a matrix times a vector.
pub(crate) fn product(matrix: &DMatrix<f64>, row: usize, vector: &[f64]) -> f64 {
    let terms = vector.iter().enumerate();
    terms.map(|(i, value)| matrix[(row, i)] * value).sum()
}

/// The symmetric part of a matrix.
pub(crate) fn symmetric(matrix: DMatrix<f64>) -> DMatrix<f64> {
    0.5 * (&matrix + matrix.transpose())
}
