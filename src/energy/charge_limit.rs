//! Quantities of charged muscles that limits bound: current and power of a source behind a resistor, charges and energies of which the steps are
//! limited, and fields.

use crate::energy::{Capacitance, Energy, OfSquare, law};
use crate::math::{Jet, Number};
use nalgebra::SVector;

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
        OfSquare::new((p, w), self.0.scale(), |_| [T::zero(); 4], half)
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
