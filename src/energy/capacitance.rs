//! The capacitance of a lumped muscle.

use crate::energy::{DielectricCell, Energy, OfSquare};
use nalgebra::SVector;

/// Capacitance `C = −2 V₀ [c₁ + c₂ I − ε/(2I)]/t²` in mC/V with I = |r|²/L₀², arguments: span r. Not finite for r = 0.
///
/// Under a voltage V the charge is C V, and the electric part of the energy of a [`DielectricCell`] is −½ C V².
#[derive(Clone, Copy, Debug)]
pub struct Capacitance {
    /// The muscle.
    pub cell: DielectricCell,
}

impl Capacitance {
    /// C at the length |r| in mm.
    pub fn at_length(&self, length: f64) -> f64 {
        let stretch = length / self.cell.elastic.length;
        self.of_squared_stretch(stretch * stretch)[0]
    }

    /// C as a function of I: value and three derivatives.
    pub(super) fn of_squared_stretch(&self, i: f64) -> [f64; 4] {
        self.cell.electric_of_squared_stretch(i).map(|e| -2.0 * e)
    }
}

impl Energy<3> for Capacitance {
    type Local<const ORDER: usize> = OfSquare;

    fn at<const ORDER: usize>(&self, p: &SVector<f64, 3>, w: &SVector<f64, 3>) -> OfSquare {
        let length = self.cell.elastic.length;
        let scale = 1.0 / (length * length);
        OfSquare::new((p, w), scale, |i| self.of_squared_stretch(i), |_| [0.0; 4])
    }
}
