//! Multipliers of constraints and bounds.

/// Multipliers of constraints and bounds, in the sign convention of Ipopt:
/// ∇f(x) + Σ yᵢ ∇gᵢ(x) − z_L + z_U = 0 with z_L, z_U ≥ 0.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Multipliers {
    /// y, one per constraint.
    pub constraints: Vec<f64>,
    /// z_L, one per variable.
    pub lower: Vec<f64>,
    /// z_U, one per variable.
    pub upper: Vec<f64>,
}

impl Multipliers {
    /// Makes them zeros of a program of n variables and m constraints.
    pub(crate) fn reset(&mut self, n: usize, m: usize) {
        let lengths = [
            (&mut self.constraints, m),
            (&mut self.lower, n),
            (&mut self.upper, n),
        ];
        for (values, length) in lengths {
            values.clear();
            values.resize(length, 0.0);
        }
    }

    /// Multiplies all by a factor; numbers that are not finite become zero.
    pub(crate) fn scale(&mut self, factor: f64) {
        for values in [&mut self.constraints, &mut self.lower, &mut self.upper] {
            for value in values {
                *value = if value.is_finite() {
                    *value * factor
                } else {
                    0.0
                };
            }
        }
    }
}
