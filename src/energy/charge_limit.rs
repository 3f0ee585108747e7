//! Quantities of charged muscles that limits bound: current and power of a source behind a resistor, charges and energies of which the steps are
//! limited, and fields.

use crate::energy::{Capacitance, Energy, OfSquare};
use crate::math::Jet;
use nalgebra::SVector;

impl Capacitance {
    /// `1/C` of a span, the first argument.
    fn inverse<const M: usize, const ORDER: usize>(
        &self,
        p: &SVector<f64, M>,
        w: &SVector<f64, M>,
    ) -> Jet<M, ORDER> {
        let squared = self.squared_stretch(p, w);
        squared.map(self.half_inverse(squared.value)) * 2.0
    }

    /// `I` of a span, the first argument.
    fn squared_stretch<const M: usize, const ORDER: usize>(
        &self,
        p: &SVector<f64, M>,
        w: &SVector<f64, M>,
    ) -> Jet<M, ORDER> {
        Jet::dot(0, 0, p, w) * self.scale()
    }

    /// `(Q/(C E))²/I` of a charge Q and the voltage E that reaches a limit field at rest length.
    fn squared_field<const M: usize, const ORDER: usize>(
        &self,
        (charge, voltage): (Jet<M, ORDER>, f64),
        p: &SVector<f64, M>,
        w: &SVector<f64, M>,
    ) -> Jet<M, ORDER> {
        let ratio = self.inverse(p, w) * charge * (1.0 / voltage);
        ratio.squared() * self.squared_stretch(p, w).recip()
    }
}

/// `(V − Q/C)/(R u)`, arguments: span r, the charge Q in its unit in the first component of a vector, voltage V of the source. The current
/// from a source through a resistor.
#[derive(Clone, Copy, Debug)]
pub struct SourceCurrent {
    /// Capacitance of the muscle.
    pub capacitance: Capacitance,
    /// Unit of the charge in mC.
    pub unit_of_charge: f64,
    /// Resistance R in Ω.
    pub resistance: f64,
    /// Unit u of the current in A.
    pub unit: f64,
}

impl Energy<7> for SourceCurrent {
    type Local<const ORDER: usize> = Jet<7, ORDER>;

    fn at<const ORDER: usize>(&self, p: &SVector<f64, 7>, w: &SVector<f64, 7>) -> Jet<7, ORDER> {
        let charge = Jet::argument(3, p, w) * self.unit_of_charge;
        let across = self.capacitance.inverse(p, w) * charge;
        (Jet::argument(6, p, w) - across) * (1.0 / (self.resistance * self.unit))
    }
}

/// V times the current, arguments as of the current. The power of a source through a resistor; the unit is one of power, W.
#[derive(Clone, Copy, Debug)]
pub struct SourcePower(pub SourceCurrent);

impl Energy<7> for SourcePower {
    type Local<const ORDER: usize> = Jet<7, ORDER>;

    fn at<const ORDER: usize>(&self, p: &SVector<f64, 7>, w: &SVector<f64, 7>) -> Jet<7, ORDER> {
        self.0.at::<ORDER>(p, w) * Jet::argument(6, p, w)
    }
}

/// `½ (C₁ + C₂) V`, arguments: spans r₁ and r₂ at both ends of an interval, voltage V. The mean charge in mC under a voltage.
#[derive(Clone, Copy, Debug)]
pub struct MeanCharge(pub Capacitance);

impl Energy<7> for MeanCharge {
    type Local<const ORDER: usize> = Jet<7, ORDER>;

    const READINGS: usize = 2;

    fn couples(i: usize, j: usize) -> bool {
        i == j
    }

    fn at<const ORDER: usize>(&self, p: &SVector<f64, 7>, w: &SVector<f64, 7>) -> Jet<7, ORDER> {
        let capacitance = |span: usize| {
            let squared = Jet::dot(span, span, p, w) * self.0.scale();
            squared.map(self.0.of_squared_stretch(squared.value))
        };
        (capacitance(0) + capacitance(3)) * Jet::argument(6, p, w) * 0.5
    }
}

/// `½ C V²`, arguments: span r, voltage V. The electric energy in mJ that a muscle stores.
#[derive(Clone, Copy, Debug)]
pub struct StoredEnergy(pub Capacitance);

impl Energy<4> for StoredEnergy {
    type Local<const ORDER: usize> = OfSquare;

    const OF_SQUARES: bool = true;

    fn at<const ORDER: usize>(&self, p: &SVector<f64, 4>, w: &SVector<f64, 4>) -> OfSquare {
        let half = |i| self.0.of_squared_stretch(i).map(|c| 0.5 * c);
        OfSquare::new((p, w), self.0.scale(), |_| [0.0; 4], half)
    }
}

/// Squared ratio of the true field of a given charge to a limit, arguments: span r, charge Q in mC.
#[derive(Clone, Copy, Debug)]
pub struct GivenChargeField {
    /// Capacitance of the muscle.
    pub capacitance: Capacitance,
    /// Voltage in V that reaches the limit field at rest length.
    pub voltage: f64,
}

impl Energy<4> for GivenChargeField {
    type Local<const ORDER: usize> = Jet<4, ORDER>;

    const OF_SQUARES: bool = true;

    fn at<const ORDER: usize>(&self, p: &SVector<f64, 4>, w: &SVector<f64, 4>) -> Jet<4, ORDER> {
        let charge = Jet::argument(3, p, w);
        self.capacitance.squared_field((charge, self.voltage), p, w)
    }
}

/// The same of a charge that flows through a resistor, arguments: span r, and the charge in its unit in the first component of a vector.
#[derive(Clone, Copy, Debug)]
pub struct FlowingChargeField {
    /// The field of the charge.
    pub field: GivenChargeField,
    /// Unit of the charge in mC.
    pub unit: f64,
}

impl Energy<6> for FlowingChargeField {
    type Local<const ORDER: usize> = Jet<6, ORDER>;

    fn at<const ORDER: usize>(&self, p: &SVector<f64, 6>, w: &SVector<f64, 6>) -> Jet<6, ORDER> {
        let charge = Jet::argument(3, p, w) * self.unit;
        let GivenChargeField {
            capacitance,
            voltage,
        } = self.field;
        capacitance.squared_field((charge, voltage), p, w)
    }
}
