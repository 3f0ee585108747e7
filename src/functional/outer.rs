//! Functions of a quantity: the residual of a constraint, or a cost.

/// Derivatives of a function c of a quantity m by its value: `∇²c(m) = c′ ∇²m + c″ ∇m ∇mᵀ`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Outer {
    /// c′: the costate of a constraint, the slope of a cost.
    pub slope: f64,
    /// c″: zero of a constraint.
    pub curvature: f64,
}

impl Outer {
    /// A function that is linear in the quantity.
    pub fn linear(slope: f64) -> Self {
        Self {
            slope,
            curvature: 0.0,
        }
    }

    /// Returns true if nothing depends on the quantity.
    pub fn is_zero(self) -> bool {
        self.slope == 0.0 && self.curvature == 0.0
    }
}
