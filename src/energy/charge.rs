//! Electric energy of a lumped muscle by its charge.
//!
//! `Q²/(2 C(I))` with I = |r|²/L₀² is the Legendre transform of the energy `−½ C V²` by the voltage V = Q/C.

use crate::energy::{DielectricCell, Energy, NeoHooke, OfSquare, law};
use crate::math::{Jet, Number};
use nalgebra::SVector;

impl<T: Number> Capacitance<T> {
    /// `1/(2C)` as a function of I: value and three derivatives.
    #[inline(always)]
    pub(super) fn half_inverse(&self, i: T) -> [T; 4] {
        let [c, c1, c2, c3] = self.of_squared_stretch(i);
        let f = c.recip();
        [
            f.scaled(0.5),
            c1.scaled(-0.5) * f * f,
            (c1 * c1 * f - c2.scaled(0.5)) * f * f,
            (c1.scaled(3.0) * (c2 - c1 * c1 * f) * f - c3.scaled(0.5)) * f * f,
        ]
    }
}

impl Capacitance {
    /// Charge in mC whose field balances the elasticity of the muscle, `√(μ V₀ C)` with C at rest.
    pub fn unit_of_charge(&self) -> f64 {
        let elastic = self.cell.elastic;
        let at_rest = self.at_length(elastic.length);
        (elastic.shear_modulus * elastic.volume * at_rest).sqrt()
    }
}

/// Energy `Q²/(2C)` of a charge that is given, arguments: span r, charge Q in mC. Not finite for r = 0 and C = 0.
#[derive(Clone, Copy, Debug)]
pub struct GivenCharge<T = f64> {
    /// Capacitance of the muscle.
    pub capacitance: Capacitance<T>,
}

law!(GivenCharge { capacitance } of 4);

impl<T: Number> Energy<4, T> for GivenCharge<T> {
    type Local<const ORDER: usize> = OfSquare<T>;

    const OF_SQUARES: bool = true;

    #[inline(always)]
    fn at<const ORDER: usize>(&self, p: &SVector<T, 4>, w: &SVector<T, 4>) -> OfSquare<T> {
        let electric = |i| self.capacitance.half_inverse(i);
        let none = |_| [T::zero(); 4];
        OfSquare::new((p, w), self.capacitance.scale(), none, electric)
    }
}

/// Energy `Q²/(2C)` of a charge that flows through a resistor, arguments: span r, and the charge in its unit in the first component of
/// a vector. Not finite for r = 0 and C = 0.
#[derive(Clone, Copy, Debug)]
pub struct FlowingCharge<T = f64> {
    /// Capacitance of the muscle.
    pub capacitance: Capacitance<T>,
    /// Unit of the charge in mC.
    pub unit: T,
}

law!(FlowingCharge { capacitance, unit } of 6);

impl<T: Number> Energy<6, T> for FlowingCharge<T> {
    type Local<const ORDER: usize> = Jet<6, ORDER, T>;

    fn at<const ORDER: usize>(&self, p: &SVector<T, 6>, w: &SVector<T, 6>) -> Jet<6, ORDER, T> {
        let squared = Jet::dot(0, 0, p, w) * self.capacitance.scale();
        let inverse = squared.map(self.capacitance.half_inverse(squared.value));
        inverse * (Jet::argument(3, p, w) * self.unit).squared()
    }
}

/// Capacitance `C = −2 V₀ [c₁ + c₂ I − ε/(2I)]/t²` in mC/V with I = |r|²/L₀², arguments: span r. Not finite for r = 0.
///
/// Under a voltage V the charge is C V, and the electric part of the energy of a [`DielectricCell`] is −½ C V².
#[derive(Clone, Copy, Debug)]
pub struct Capacitance<T = f64> {
    /// The muscle.
    pub cell: DielectricCell<NeoHooke, T>,
}

law!(Capacitance { cell } of 3);

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
