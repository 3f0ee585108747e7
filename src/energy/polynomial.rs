//! Constants of formulas that follow from free parameters.

use crate::math::Number;

/// A constant of a formula as a function of free parameters π: `value + Σ (factor · π + a π² + b π³)`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Polynomial {
    /// The part that no parameter changes.
    pub value: f64,
    /// Places of parameters among those of the element, and their factors.
    pub slopes: Vec<(usize, f64)>,
    /// Places of parameters, and the factors a and b of their squares and cubes.
    pub higher: Vec<(usize, [f64; 2])>,
}

impl From<f64> for Polynomial {
    fn from(value: f64) -> Self {
        Self {
            value,
            ..Self::default()
        }
    }
}

impl Polynomial {
    /// `factor · self + value`.
    #[must_use]
    pub fn scaled(&self, factor: f64, value: f64) -> Self {
        Self::from(value).plus(factor, self)
    }

    /// `self + factor · other`.
    #[must_use]
    pub fn plus(mut self, factor: f64, other: &Self) -> Self {
        self.value += factor * other.value;
        let slopes = other.slopes.iter().map(|&(i, slope)| (i, factor * slope));
        self.slopes.extend(slopes);
        let higher = other.higher.iter();
        self.higher
            .extend(higher.map(|&(i, powers)| (i, powers.map(|p| factor * p))));
        self
    }

    /// Returns true if no parameter changes it.
    pub fn is_given(&self) -> bool {
        self.slopes.is_empty() && self.higher.is_empty()
    }

    /// Its value at parameters.
    #[inline(always)]
    pub fn at<T: Number>(&self, parameters: &[T]) -> T {
        self.of(|place| parameters[place])
    }

    /// Its value at the parameters of places.
    #[inline(always)]
    pub fn of<T: Number>(&self, parameter: impl Fn(usize) -> T) -> T {
        let mut sum = T::of(self.value);
        for &(place, factor) in &self.slopes {
            sum += parameter(place).scaled(factor);
        }
        for &(place, [a, b]) in &self.higher {
            let value = parameter(place);
            sum += value * value * value.scaled(b).shifted(a);
        }
        sum
    }
}
