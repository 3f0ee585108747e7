//! Costs of quantities: what a motion pays for what it does, beside its voltages.

use crate::control::signal::Signal;
use crate::model::Quantity;

/// Weights of the objective; a weight of zero leaves no trace.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Objective {
    /// Of Σ h |V_k|², V in kV, h in s.
    pub effort: f64,
    /// Of Σ_{k=0..N} |V_k − V_{k−1}|²/h with the rest voltages of start and goal at the ends.
    pub rate: f64,
    /// Of the final time in s.
    pub duration: f64,
    /// Costs of quantities.
    pub quantities: Vec<QuantityCost>,
}

/// A function of a quantity that is minimised.
#[derive(Clone, Debug, PartialEq)]
pub struct QuantityCost {
    /// The quantity m.
    pub quantity: Quantity,
    /// Weight of the cost, positive.
    pub weight: f64,
    /// What is made of the quantity.
    pub function: CostFunction,
    /// When it is paid for.
    pub during: During,
}

/// What a cost makes of a quantity m.
#[derive(Clone, Debug, PartialEq)]
pub enum CostFunction {
    /// (m − r(t))², in mm², or rad² with the difference of angles nearest to zero.
    Square {
        /// What the quantity follows, r(t) in its unit.
        reference: Signal,
    },
}

/// When a cost is paid.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum During {
    /// All the time: the integral over the time in s by the trapezoidal rule.
    Motion,
    /// At the final instant.
    End,
}

impl QuantityCost {
    /// Whether its second derivative by the quantity is other than zero.
    pub fn is_curved(&self) -> bool {
        match self.function {
            CostFunction::Square { .. } => true,
        }
    }
}
