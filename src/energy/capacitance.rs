//! The capacitance of a lumped muscle.

use crate::energy::{DielectricCell, Energy, NeoHooke, OfSquare};
use crate::math::Number;
use nalgebra::SVector;

/// Capacitance `C = −2 V₀ [c₁ + c₂ I − ε/(2I)]/t²` in mC/V with I = |r|²/L₀², arguments: span r. Not finite for r = 0.
///
/// Under a voltage V the charge is C V, and the electric part of the energy of a [`DielectricCell`] is −½ C V².
#[derive(Clone, Copy, Debug)]
pub struct Capacitance<T = f64> {
    /// The muscle.
    pub cell: DielectricCell<NeoHooke, T>,
}

impl Capacitance {
    /// C at the length |r| in mm.
    pub fn at_length(&self, length: f64) -> f64 {
        let stretch = length / self.cell.elastic.length;
        self.of_squared_stretch(stretch * stretch)[0]
    }
}

impl<T: Number> Capacitance<T> {
    /// C as a function of I: value and three derivatives.
    pub(super) fn of_squared_stretch(&self, i: T) -> [T; 4] {
        let electric = self.cell.electric_of_squared_stretch(i);
        electric.map(|e| e.scaled(-2.0))
    }

    /// Factor of |r|² in I.
    pub(super) fn scale(&self) -> T {
        let length = self.cell.elastic.length;
        (length * length).recip()
    }
}

impl<T: Number> Energy<3, T> for Capacitance<T> {
    type Local<const ORDER: usize> = OfSquare<T>;

    fn at<const ORDER: usize>(&self, p: &SVector<T, 3>, w: &SVector<T, 3>) -> OfSquare<T> {
        let none = |_| [T::zero(); 4];
        OfSquare::new((p, w), self.scale(), |i| self.of_squared_stretch(i), none)
    }
}
