//! Argument that reads a scalar of an interval.

/// A constant plus a factor times a scalar of the interval: the potential of a node.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ScalarArg {
    /// The constant in V.
    pub constant: f64,
    /// Scalar and factor.
    pub scalar: Option<(usize, f64)>,
}

impl ScalarArg {
    /// Its value.
    #[inline]
    pub fn read(self, scalars: &[f64]) -> f64 {
        self.constant + self.scalar.map_or(0.0, |(s, factor)| factor * scalars[s])
    }

    /// Its rate, from those of the scalars.
    #[inline]
    pub fn rate(self, along: &[f64]) -> f64 {
        self.scalar.map_or(0.0, |(s, factor)| factor * along[s])
    }
}
