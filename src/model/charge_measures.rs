//! Measures of charges and sources: behind resistors the field of the charge, current and power; otherwise charge and energy under the voltage.

use crate::energy::{
    Capacitance, FlowingChargeField, GivenChargeField, MeanCharge, SourceCurrent, SourcePower,
    StoredEnergy,
};
use crate::functional::{Measure, Stencil};
use crate::kinematics::Vectors;
use crate::model::components::capacitance;
use crate::model::internal::InternalKind;
use crate::model::measures::{Known, Shape, instant, interval};
use crate::model::quantity::Quantity;

/// Vectors of span and charge, and the scalar of the voltage.
type Read = ([(usize, Stencil); 2], [usize; 1]);

impl Known<'_> {
    /// The measure of a quantity of a muscle and its source.
    pub(super) fn of_charge(
        &self,
        quantity: &Quantity,
        shape: Shape,
        vectors: &mut Vectors,
    ) -> Option<Box<dyn Measure>> {
        Some(match *quantity {
            Quantity::ChargedField { muscle, limit } => {
                let (capacitance, read) = self.charged(muscle, vectors)?;
                let voltage = self.presolved.system.muscles[muscle].layer_thickness * limit;
                let field = GivenChargeField {
                    capacitance,
                    voltage,
                };
                let unit = capacitance.unit_of_charge();
                instant(shape, FlowingChargeField { field, unit }, read)
            }
            Quantity::SourceCurrent { muscle, unit } => {
                let (current, (read, scalars)) = self.source_current(muscle, unit, vectors)?;
                interval::<_, 7, 2, 1>(shape, current, read, scalars)
            }
            Quantity::SourcePower { muscle, unit } => {
                let (current, (read, scalars)) = self.source_current(muscle, unit, vectors)?;
                interval::<_, 7, 2, 1>(shape, SourcePower(current), read, scalars)
            }
            Quantity::ChargeStep { muscle, .. } => {
                let (capacitance, span, voltage) = self.direct(muscle, vectors)?;
                let ends = [(span, Stencil::Here), (span, Stencil::Next)];
                interval::<_, 7, 2, 1>(shape, MeanCharge(capacitance), ends, [voltage])
            }
            Quantity::EnergyStep { muscle, at, .. } => {
                let (capacitance, span, voltage) = self.direct(muscle, vectors)?;
                interval::<_, 4, 1, 1>(shape, StoredEnergy(capacitance), [(span, at)], [voltage])
            }
            _ => return None,
        })
    }

    /// Capacitance of a muscle without a resistor, the vector of its span, and the scalar of its voltage.
    fn direct(&self, muscle: usize, vectors: &mut Vectors) -> Option<(Capacitance, usize, usize)> {
        let voltage = self.variables.input(muscle)?;
        let capacitance = capacitance(&self.presolved.system.muscles[muscle])?;
        Some((capacitance, self.span(muscle, vectors), voltage))
    }

    /// Capacitance of a muscle behind a resistor, with the vectors of its span and of its charge.
    fn charged(&self, muscle: usize, vectors: &mut Vectors) -> Option<(Capacitance, [usize; 2])> {
        let charge = self.internals.vector(InternalKind::Charge(muscle))?;
        let capacitance = capacitance(&self.presolved.system.muscles[muscle])?;
        let read = [self.span(muscle, vectors), vectors.index(charge)];
        Some((capacitance, read))
    }

    /// Current of the source of a muscle behind a resistor in a unit, with what it reads.
    fn source_current(
        &self,
        muscle: usize,
        unit: f64,
        vectors: &mut Vectors,
    ) -> Option<(SourceCurrent, Read)> {
        let voltage = self.variables.input(muscle)?;
        let (capacitance, read) = self.charged(muscle, vectors)?;
        let circuit = self.presolved.system.muscles[muscle].circuit?;
        let current = SourceCurrent {
            capacitance,
            unit_of_charge: capacitance.unit_of_charge(),
            resistance: circuit.resistance?,
            unit,
        };
        Some((current, (read.map(|v| (v, Stencil::Mid)), [voltage])))
    }
}
