//! Constants of formulas that follow from sought parameters.

use crate::math::Number;

/// A constant of a formula as a function of sought parameters π: `value + Σ factor · π`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Affine {
    /// The part that no parameter changes.
    pub value: f64,
    /// Places of parameters among those of the element, and their factors.
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
    /// `factor · self + value`.
    #[must_use]
    pub fn scaled(&self, factor: f64, value: f64) -> Self {
        let slopes = self.slopes.iter().map(|&(i, slope)| (i, factor * slope));
        Self {
            value: factor * self.value + value,
            slopes: slopes.collect(),
        }
    }

    /// `self + factor · other`.
    #[must_use]
    pub fn plus(mut self, factor: f64, other: &Self) -> Self {
        self.value += factor * other.value;
        let slopes = other.slopes.iter().map(|&(i, slope)| (i, factor * slope));
        self.slopes.extend(slopes);
        self
    }

    /// Its value at parameters.
    #[inline(always)]
    pub fn at<T: Number>(&self, parameters: &[T]) -> T {
        let mut sum = T::of(self.value);
        for &(place, factor) in &self.slopes {
            sum += parameters[place].scaled(factor);
        }
        sum
    }
}
