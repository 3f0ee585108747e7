//! The peak of the voltages as a cost, by its epigraph.
//!
//! One sought parameter s bounds all voltages that are sought, and its square is a final cost:
//!
//! ```text
//! minimise … + w s²   subject to   V_k² ≤ s²  of all sources and intervals k,   V in kV.
//! ```

use crate::control::problem::{Control, PathConstraint};
use crate::control::quantity_cost::{CostFunction, During, QuantityCost};
use crate::math::Signal;
use crate::model::{Constant, Parameter, Quantity, System};

/// Name of the parameter that is the peak.
pub const PEAK_VOLTAGE: &str = "peak voltage";

impl Control {
    /// Adds the square of the largest voltage in kV that is sought, with a positive weight, to the objective. Returns false if no
    /// voltage is sought.
    pub fn minimise_peak_voltage(&mut self, weight: f64, system: &System) -> bool {
        let sources = system.sources().into_iter().enumerate();
        let sought = sources.filter(|(s, source)| source.takes_voltage && !self.is_given(*s));
        let sought: Vec<usize> = sought.map(|(source, _)| source).collect();
        if sought.is_empty() {
            return false;
        }
        let (parameter, unit) = (self.parameters.len(), self.voltage_size(system));
        let [low, high] = self.voltage_bounds.map(f64::abs);
        let upper = low.max(high);
        self.parameters.push(Parameter {
            name: PEAK_VOLTAGE.to_owned(),
            constants: vec![Constant::PeakVoltage.into()],
            lower: 0.0,
            upper,
            guess: if upper.is_finite() { upper } else { unit },
        });
        let limit = |source| PathConstraint::PeakVoltage {
            source,
            parameter,
            unit,
        };
        self.limits.extend(sought.into_iter().map(limit));
        self.objective.quantities.push(QuantityCost {
            quantity: Quantity::PeakVoltage { parameter },
            weight,
            function: CostFunction::Square {
                reference: Signal::Constant(0.0),
            },
            during: During::End,
        });
        true
    }
}
