//! Laws of quantities of lumped muscles and their sources that limits and costs read.

use crate::energy::{
    FlowingCharge, FlowingChargeField, GivenChargeField, MeanCharge, Polynomial, PotentialDrop,
    SourceCurrent, SourcePower, SpanTension, SquaredDistance, SquaredField, StoredEnergy,
    ViscousTension, VoltageAcross,
};
use crate::functional::Law;
use crate::math::Number;
use crate::model::components::muscle_laws::{Flowing, OfCapacitance, Shape, Viscous};
use nalgebra::Vector3;

/// Squared stretch.
#[derive(Clone)]
pub(in crate::model) struct Stretch(pub(in crate::model) Shape);

impl Law<3> for Stretch {
    type Formula<T: Number> = SquaredDistance<T>;

    fn formula<T: Number>(&self, parameters: &[T]) -> SquaredDistance<T> {
        SquaredDistance {
            centre: Vector3::zeros(),
            scale: self.0.length(parameters),
        }
    }
}

/// Squared ratio of the true field of a voltage to a limit in V/mm.
#[derive(Clone)]
pub(in crate::model) struct Field {
    pub(in crate::model) shape: Shape,
    /// Thickness of a layer in mm.
    pub(in crate::model) layer: Polynomial,
    pub(in crate::model) limit: f64,
}

impl Law<4> for Field {
    type Formula<T: Number> = SquaredField<T>;

    fn formula<T: Number>(&self, parameters: &[T]) -> SquaredField<T> {
        SquaredField {
            length: self.shape.length(parameters),
            voltage: self.layer.at(parameters).scaled(self.limit),
        }
    }
}

/// The same of a given charge.
#[derive(Clone)]
pub(in crate::model) struct GivenField {
    pub(in crate::model) capacitance: OfCapacitance,
    /// The limit in V/mm.
    pub(in crate::model) limit: f64,
}

impl Law<4> for GivenField {
    type Formula<T: Number> = GivenChargeField<T>;

    fn formula<T: Number>(&self, parameters: &[T]) -> GivenChargeField<T> {
        let capacitance = self.capacitance.formula(parameters);
        GivenChargeField {
            capacitance,
            voltage: capacitance.cell.layer.scaled(self.limit),
        }
    }
}

/// The same of a charge that flows through a resistor.
#[derive(Clone)]
pub(in crate::model) struct FlowingField {
    pub(in crate::model) field: GivenField,
    /// Unit of the charge in mC.
    pub(in crate::model) unit: f64,
}

impl Law<6> for FlowingField {
    type Formula<T: Number> = FlowingChargeField<T>;

    fn formula<T: Number>(&self, parameters: &[T]) -> FlowingChargeField<T> {
        FlowingChargeField {
            field: self.field.formula(parameters),
            unit: T::of(self.unit),
        }
    }
}

/// Current of a source through a resistor in a unit in A.
#[derive(Clone)]
pub(in crate::model) struct Current {
    pub(in crate::model) of: Flowing,
    /// Resistance in Ω.
    pub(in crate::model) resistance: Polynomial,
    pub(in crate::model) unit: f64,
}

impl Law<7> for Current {
    type Formula<T: Number> = SourceCurrent<T>;

    fn formula<T: Number>(&self, parameters: &[T]) -> SourceCurrent<T> {
        let FlowingCharge { capacitance, unit } = self.of.formula(parameters);
        SourceCurrent {
            capacitance,
            unit_of_charge: unit,
            resistance: self.resistance.at(parameters),
            unit: T::of(self.unit),
        }
    }
}

/// Voltage of a charge behind a resistor.
#[derive(Clone)]
pub(in crate::model) struct Across(pub(in crate::model) Flowing);

impl Law<6> for Across {
    type Formula<T: Number> = VoltageAcross<T>;

    fn formula<T: Number>(&self, parameters: &[T]) -> VoltageAcross<T> {
        let FlowingCharge { capacitance, unit } = self.0.formula(parameters);
        VoltageAcross { capacitance, unit }
    }
}

/// Current through a resistor to electrodes with a potential, in a unit in A.
#[derive(Clone)]
pub(in crate::model) struct Drop {
    /// Unit of the potential in V.
    pub(in crate::model) unit: f64,
    pub(in crate::model) resistance: Polynomial,
    pub(in crate::model) of_current: f64,
}

impl Law<2> for Drop {
    type Formula<T: Number> = PotentialDrop<T>;

    fn formula<T: Number>(&self, parameters: &[T]) -> PotentialDrop<T> {
        PotentialDrop {
            unit: T::of(self.unit),
            resistance: self.resistance.at(parameters).scaled(self.of_current),
        }
    }
}

/// Power of a source through a resistor in a unit in W.
#[derive(Clone)]
pub(in crate::model) struct Power(pub(in crate::model) Current);

impl Law<7> for Power {
    type Formula<T: Number> = SourcePower<T>;

    fn formula<T: Number>(&self, parameters: &[T]) -> SourcePower<T> {
        SourcePower(self.0.formula(parameters))
    }
}

/// Mean charge under a voltage.
#[derive(Clone)]
pub(in crate::model) struct Mean(pub(in crate::model) OfCapacitance);

impl Law<7> for Mean {
    type Formula<T: Number> = MeanCharge<T>;

    fn formula<T: Number>(&self, parameters: &[T]) -> MeanCharge<T> {
        MeanCharge(self.0.formula(parameters))
    }
}

/// Stored energy under a voltage.
#[derive(Clone)]
pub(in crate::model) struct Stored(pub(in crate::model) OfCapacitance);

impl Law<4> for Stored {
    type Formula<T: Number> = StoredEnergy<T>;

    fn formula<T: Number>(&self, parameters: &[T]) -> StoredEnergy<T> {
        StoredEnergy(self.0.formula(parameters))
    }
}

/// Force of an energy along the span of a muscle.
#[derive(Clone)]
pub(in crate::model) struct Tension<L>(pub(in crate::model) L);

impl<L: Law<M>, const M: usize> Law<M> for Tension<L> {
    type Formula<T: Number> = SpanTension<L::Formula<T>>;

    fn formula<T: Number>(&self, parameters: &[T]) -> Self::Formula<T> {
        SpanTension(self.0.formula(parameters))
    }
}

/// Force of viscosity along the span of a muscle.
#[derive(Clone)]
pub(in crate::model) struct ViscousForce(pub(in crate::model) Viscous);

impl Law<6> for ViscousForce {
    type Formula<T: Number> = ViscousTension<T>;

    fn formula<T: Number>(&self, parameters: &[T]) -> ViscousTension<T> {
        ViscousTension(self.0.formula(parameters))
    }
}
