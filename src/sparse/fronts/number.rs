//! Numbers of factors: of double precision, or of single precision in half the memory.

use faer::traits::RealField;

use crate::sparse::Precision;

/// A number of a factor.
pub(crate) trait Number: RealField + Copy + Default {
    /// Its precision.
    const PRECISION: Precision;
    /// LDLᵀ with such numbers, as a table names it.
    const LDLT: &'static str;

    /// The nearest number.
    fn near(value: f64) -> Self;

    /// The number in double precision.
    fn value(self) -> f64;
}

impl Number for f64 {
    const PRECISION: Precision = Precision::Double;
    const LDLT: &'static str = "LDLᵀ by fronts";

    fn near(value: f64) -> Self {
        value
    }

    fn value(self) -> f64 {
        self
    }
}

impl Number for f32 {
    const PRECISION: Precision = Precision::Single;
    const LDLT: &'static str = "LDLᵀ by fronts in single precision";

    fn near(value: f64) -> Self {
        value as Self
    }

    fn value(self) -> f64 {
        self.into()
    }
}
