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

use crate::feedback::radius::spectral_radius;
use crate::feedback::riccati::{Costs, riccati_step, symmetric};
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
