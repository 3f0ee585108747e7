//! Lumped muscles whose electrodes have a charge instead of the voltage of a source.

use crate::model::components::{LoadPlace, capacitance};
use crate::model::layout::internal::InternalKind;
use crate::model::layout::variables::{Role, Variable};
use crate::model::model::Model;
use crate::model::system::circuit::Circuit;
use crate::model::system::{Muscle, System};
use std::borrow::Cow;
use std::collections::BTreeMap;

impl System {
    /// Returns true if a load gives a muscle its charge, so that its voltage follows.
    pub fn is_charged(&self, muscle: usize) -> bool {
        let mut loads = self.components.loads.iter();
        loads.any(|load| load.on == LoadPlace::Muscle(muscle))
    }

    /// Current in A and power in W of the source of a muscle behind a resistor without charge, under a voltage whose field balances the
    /// elasticity of the muscle; one without a resistor.
    pub fn short_circuit(&self, muscle: usize) -> [f64; 2] {
        let muscle = &self.muscles[muscle];
        let resistance = muscle.circuit.and_then(|circuit| circuit.resistance);
        let sizes = resistance.zip(capacitance(muscle)).map(|(r, capacitance)| {
            let at_rest = capacitance.at_length(muscle.length());
            let voltage = capacitance.unit_of_charge() / at_rest;
            [voltage / r, voltage * voltage / r]
        });
        sizes.unwrap_or([1.0; 2])
    }

    /// Charge in mC and energy in mJ of a muscle under a voltage whose field balances its elasticity; one without a capacitance.
    pub fn charging(&self, muscle: usize) -> [f64; 2] {
        let muscle = &self.muscles[muscle];
        let sizes = capacitance(muscle).map(|capacitance| {
            let charge = capacitance.unit_of_charge();
            [
                charge,
                charge * charge / capacitance.at_length(muscle.length()),
            ]
        });
        sizes.unwrap_or([1.0; 2])
    }

    /// The source of the charge of a muscle, where a load gives it.
    pub fn charge_of(&self, muscle: usize) -> Option<usize> {
        let mut loads = self.components.loads.iter();
        let own = loads.position(|load| load.on == LoadPlace::Muscle(muscle))?;
        Some(self.first_load() + own)
    }

    /// Returns true if the electrodes of a muscle have the voltage of a source.
    pub fn has_source_voltage(&self, muscle: usize) -> bool {
        !self.muscles[muscle].is_behind_resistor() && !self.is_charged(muscle)
    }
}

impl Muscle {
    /// Returns true if a resistor lies between its source and its electrodes, so that its charge is an unknown.
    pub fn is_behind_resistor(&self) -> bool {
        self.inner_resistance().is_some()
    }

    /// Returns true if the charge that flows from its source can be limited: behind a resistor, or of a lumped muscle with a capacitance that
    /// does not leak.
    pub fn has_measured_current(&self) -> bool {
        capacitance(self).is_some() && (self.is_behind_resistor() || self.circuit.is_none())
    }

    /// Resistance in Ω of the source that stands for its circuit; none without a resistor.
    pub fn inner_resistance(&self) -> Option<f64> {
        self.circuit.as_ref().and_then(Circuit::inner_resistance)
    }

    /// Voltage of its electrodes at rest under a voltage of its source.
    pub fn voltage_at_rest(&self, voltage: f64) -> f64 {
        let division = self.circuit.as_ref().and_then(Circuit::division);
        division.map_or(voltage, |part| part * voltage)
    }

    /// The muscle whose field under the voltage of its source is the one that its circuit leaves at rest: its layers are thicker behind a
    /// resistor with a leak.
    pub(crate) fn at_rest(&self) -> Cow<'_, Self> {
        let part = self.voltage_at_rest(1.0);
        match part < 1.0 {
            true => Cow::Owned(Self {
                layer_thickness: self.layer_thickness / part,
                ..self.clone()
            }),
            false => Cow::Borrowed(self),
        }
    }

    /// Returns true if a circuit can charge it.
    pub fn takes_circuit(&self) -> bool {
        let is_lumped = capacitance(self).is_some_and(|c| c.at_length(self.length()) > 0.0);
        is_lumped || (self.is_meshed() && self.material.electric.is_some())
    }

    /// Returns true if its charge can be given.
    pub fn takes_charge(&self) -> bool {
        capacitance(self).is_some() && self.circuit.is_none()
    }
}

impl Model {
    /// The source of whose muscle or electrodes coordinate `i` is the charge.
    pub fn charge(&self, i: usize) -> Option<usize> {
        match self.internal_kind(i)? {
            InternalKind::Charge(source) => Some(source),
            _ => None,
        }
    }

    /// The unit in mC of coordinate `i` where it is a charge.
    pub fn unit_of_charge(&self, i: usize) -> Option<f64> {
        let source = self.charge(i)?;
        let mut circuits = self.electrode_circuits.iter();
        match circuits.find(|of| of.source == source) {
            Some(of) => Some(of.unit_of_charge),
            None => Some(capacitance(self.system.muscles.get(source)?)?.unit_of_charge()),
        }
    }

    /// Charge in mC of each muscle and of electrodes behind a resistor, by source, at instants with coordinates z.
    pub fn circuit_charges(&self, z: &[Vec<f64>]) -> BTreeMap<usize, Vec<f64>> {
        let charges = self.action.map.internal().filter_map(|coordinate| {
            let (source, unit) = (self.charge(coordinate)?, self.unit_of_charge(coordinate)?);
            let charges = z.iter().map(|z| z[coordinate] * unit);
            Some((source, charges.collect()))
        });
        charges.collect()
    }

    /// Charges in mC of what voltages drive, from the derivatives by the scalars of an interval of h ms: `−∂W/∂V`, in which a leak
    /// behind a resistor divides the voltage.
    pub fn charges(&self, by_scalars: &[f64], h: f64) -> Vec<f64> {
        let rows = &by_scalars[self.variables.range(Role::Voltage)];
        let voltages = self.variables.with(Role::Voltage).iter();
        let charge = |(row, voltage): (&f64, &Variable)| {
            let division = voltage.source.map(|source| self.system.division(source));
            row / h / division.unwrap_or(1.0)
        };
        rows.iter().zip(voltages).map(charge).collect()
    }
}
