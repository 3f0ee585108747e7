//! Electric energy of a lumped muscle by its charge, and what limits bound of charged muscles: current and power of a source behind a resistor,
//! charges and energies of which the steps are limited, and fields.
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
        OfSquare::new(p, w, self.capacitance.scale(), none, electric)
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
        OfSquare::new(p, w, self.scale(), |i| self.of_squared_stretch(i), none)
    }
}

impl<T: Number> Capacitance<T> {
    /// `1/C` of a span, the first argument.
    fn inverse<const M: usize, const ORDER: usize>(
        &self,
        p: &SVector<T, M>,
        w: &SVector<T, M>,
    ) -> Jet<M, ORDER, T> {
        let squared = self.squared_stretch(p, w);
        squared.map(self.half_inverse(squared.value)).scaled(2.0)
    }

    /// `I` of a span, the first argument.
    fn squared_stretch<const M: usize, const ORDER: usize>(
        &self,
        p: &SVector<T, M>,
        w: &SVector<T, M>,
    ) -> Jet<M, ORDER, T> {
        Jet::dot(0, 0, p, w) * self.scale()
    }

    /// `(Q/(C E))²/I` of a charge Q and the voltage E that reaches a limit field at rest length.
    fn squared_field<const M: usize, const ORDER: usize>(
        &self,
        charge: Jet<M, ORDER, T>,
        voltage: T,
        p: &SVector<T, M>,
        w: &SVector<T, M>,
    ) -> Jet<M, ORDER, T> {
        let ratio = self.inverse(p, w) * charge * voltage.recip();
        ratio.squared() * self.squared_stretch(p, w).recip()
    }
}

/// `(V − Q/C)/(R u)`, arguments: span r, the charge Q in its unit in the first component of a vector, voltage V of the source. The current
/// from a source through a resistor.
#[derive(Clone, Copy, Debug)]
pub struct SourceCurrent<T = f64> {
    /// Capacitance of the muscle.
    pub capacitance: Capacitance<T>,
    /// Unit of the charge in mC.
    pub unit_of_charge: T,
    /// Resistance R in Ω.
    pub resistance: T,
    /// Unit u of the current in A.
    pub unit: T,
}

law!(SourceCurrent { capacitance, unit_of_charge, resistance, unit } of 7);

impl<T: Number> Energy<7, T> for SourceCurrent<T> {
    type Local<const ORDER: usize> = Jet<7, ORDER, T>;

    fn at<const ORDER: usize>(&self, p: &SVector<T, 7>, w: &SVector<T, 7>) -> Jet<7, ORDER, T> {
        let charge = Jet::argument(3, p, w) * self.unit_of_charge;
        let across = self.capacitance.inverse(p, w) * charge;
        (Jet::argument(6, p, w) - across) * (self.resistance * self.unit).recip()
    }
}

/// `(V − u φ)/R`, arguments: voltage V of the source, potential φ in its unit u. The current from a source through a resistor to electrodes.
#[derive(Clone, Copy, Debug)]
pub struct PotentialDrop<T = f64> {
    /// Unit u of the potential in V.
    pub unit: T,
    /// Resistance R in Ω.
    pub resistance: T,
}

law!(PotentialDrop { unit, resistance } of 2);

impl<T: Number> Energy<2, T> for PotentialDrop<T> {
    type Local<const ORDER: usize> = Jet<2, ORDER, T>;

    fn at<const ORDER: usize>(&self, p: &SVector<T, 2>, w: &SVector<T, 2>) -> Jet<2, ORDER, T> {
        let across = Jet::argument(1, p, w) * self.unit;
        (Jet::argument(0, p, w) - across) * self.resistance.recip()
    }
}

/// `Q/C`, arguments: span r, the charge Q in its unit in the first component of a vector. The voltage of electrodes behind a resistor.
#[derive(Clone, Copy, Debug)]
pub struct VoltageAcross<T = f64> {
    /// Capacitance of the muscle.
    pub capacitance: Capacitance<T>,
    /// Unit of the charge in mC.
    pub unit: T,
}

law!(VoltageAcross { capacitance, unit } of 6);

impl<T: Number> Energy<6, T> for VoltageAcross<T> {
    type Local<const ORDER: usize> = Jet<6, ORDER, T>;

    fn at<const ORDER: usize>(&self, p: &SVector<T, 6>, w: &SVector<T, 6>) -> Jet<6, ORDER, T> {
        self.capacitance.inverse(p, w) * (Jet::argument(3, p, w) * self.unit)
    }
}

/// V times the current, arguments as of the current. The power of a source through a resistor; the unit is one of power, W.
#[derive(Clone, Copy, Debug)]
pub struct SourcePower<T = f64>(pub SourceCurrent<T>);

law!(SourcePower { 0 } of 7);

impl<T: Number> Energy<7, T> for SourcePower<T> {
    type Local<const ORDER: usize> = Jet<7, ORDER, T>;

    fn at<const ORDER: usize>(&self, p: &SVector<T, 7>, w: &SVector<T, 7>) -> Jet<7, ORDER, T> {
        self.0.at::<ORDER>(p, w) * Jet::argument(6, p, w)
    }
}

/// `½ (C₁ + C₂) V`, arguments: spans r₁ and r₂ at both ends of an interval, voltage V. The mean charge in mC under a voltage.
#[derive(Clone, Copy, Debug)]
pub struct MeanCharge<T = f64>(pub Capacitance<T>);

law!(MeanCharge { 0 } of 7);

impl<T: Number> Energy<7, T> for MeanCharge<T> {
    type Local<const ORDER: usize> = Jet<7, ORDER, T>;

    const READINGS: usize = 2;

    fn couples(i: usize, j: usize) -> bool {
        i == j
    }

    fn at<const ORDER: usize>(&self, p: &SVector<T, 7>, w: &SVector<T, 7>) -> Jet<7, ORDER, T> {
        let capacitance = |span: usize| {
            let squared = Jet::dot(span, span, p, w) * self.0.scale();
            squared.map(self.0.of_squared_stretch(squared.value))
        };
        ((capacitance(0) + capacitance(3)) * Jet::argument(6, p, w)).scaled(0.5)
    }
}

/// `½ C V²`, arguments: span r, voltage V. The electric energy in mJ that a muscle stores.
#[derive(Clone, Copy, Debug)]
pub struct StoredEnergy<T = f64>(pub Capacitance<T>);

law!(StoredEnergy { 0 } of 4);

impl<T: Number> Energy<4, T> for StoredEnergy<T> {
    type Local<const ORDER: usize> = OfSquare<T>;

    const OF_SQUARES: bool = true;

    fn at<const ORDER: usize>(&self, p: &SVector<T, 4>, w: &SVector<T, 4>) -> OfSquare<T> {
        let half = |i| self.0.of_squared_stretch(i).map(|c| c.scaled(0.5));
        OfSquare::new(p, w, self.0.scale(), |_| [T::zero(); 4], half)
    }
}

/// Squared ratio of the true field of a given charge to a limit, arguments: span r, charge Q in mC.
#[derive(Clone, Copy, Debug)]
pub struct GivenChargeField<T = f64> {
    /// Capacitance of the muscle.
    pub capacitance: Capacitance<T>,
    /// Voltage in V that reaches the limit field at rest length.
    pub voltage: T,
}

law!(GivenChargeField { capacitance, voltage } of 4);

impl<T: Number> Energy<4, T> for GivenChargeField<T> {
    type Local<const ORDER: usize> = Jet<4, ORDER, T>;

    const OF_SQUARES: bool = true;

    fn at<const ORDER: usize>(&self, p: &SVector<T, 4>, w: &SVector<T, 4>) -> Jet<4, ORDER, T> {
        let charge = Jet::argument(3, p, w);
        self.capacitance.squared_field(charge, self.voltage, p, w)
    }
}

/// The same of a charge that flows through a resistor, arguments: span r, and the charge in its unit in the first component of a vector.
#[derive(Clone, Copy, Debug)]
pub struct FlowingChargeField<T = f64> {
    /// The field of the charge.
    pub field: GivenChargeField<T>,
    /// Unit of the charge in mC.
    pub unit: T,
}

law!(FlowingChargeField { field, unit } of 6);

impl<T: Number> Energy<6, T> for FlowingChargeField<T> {
    type Local<const ORDER: usize> = Jet<6, ORDER, T>;

    fn at<const ORDER: usize>(&self, p: &SVector<T, 6>, w: &SVector<T, 6>) -> Jet<6, ORDER, T> {
        let charge = Jet::argument(3, p, w) * self.unit;
        let GivenChargeField {
            capacitance,
            voltage,
        } = self.field;
        capacitance.squared_field(charge, voltage, p, w)
    }
}
