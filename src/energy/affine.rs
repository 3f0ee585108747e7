//! Constants of formulas that follow from sought parameters.

use crate::math::Jet;
use nalgebra::SVector;

/// A constant of a formula as a function of its arguments: `value + Σ factor · argument`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Affine {
    /// The part that no argument changes.
    pub value: f64,
    /// Arguments and their factors.
    pub slopes: Vec<(usize, f64)>,
}

impl From<f64> for Affine {
    fn from(value: f64) -> Self {
        Self {
            value,
            slopes: Vec::new(),
        }
    }
}

impl Affine {
    /// A multiple of an argument.
    pub fn single(argument: usize, factor: f64) -> Self {
        Self {
            value: 0.0,
            slopes: vec![(argument, factor)],
        }
    }

    /// `factor · self + value`.
    #[must_use]
    pub fn scaled(&self, factor: f64, value: f64) -> Self {
        let slopes = self.slopes.iter().map(|&(i, slope)| (i, factor * slope));
        Self {
            value: factor * self.value + value,
            slopes: slopes.collect(),
        }
    }

    /// Its jet at the arguments p, with rates along w.
    pub fn jet<const M: usize, const ORDER: usize>(
        &self,
        p: &SVector<f64, M>,
        w: &SVector<f64, M>,
    ) -> Jet<M, ORDER> {
        let mut jet = Jet::constant(self.value);
        for &(i, factor) in &self.slopes {
            jet.value += factor * p[i];
            jet.gradient[i] += factor;
            jet.value_w += factor * w[i];
        }
        jet
    }
}
