//! Lumped muscles whose electrodes have a charge instead of the voltage of a source, and the voltages that follow.

use crate::coordinates::Configuration;
use crate::energy::Capacitance;
use crate::model::components::{LoadPlace, capacitance};
use crate::model::internal::InternalKind;
use crate::model::model::Model;
use crate::model::system::{Muscle, System};
use std::collections::BTreeMap;

impl System {
    /// Returns true if a load gives a muscle its charge, so that its voltage follows.
    pub fn is_charged(&self, muscle: usize) -> bool {
        let mut loads = self.components.loads.iter();
        loads.any(|load| load.on == LoadPlace::Muscle(muscle))
    }

    /// Returns true if the electrodes of a muscle have the voltage of a source.
    pub fn has_source_voltage(&self, muscle: usize) -> bool {
        self.muscles[muscle].circuit.is_none() && !self.is_charged(muscle)
    }
}

impl Muscle {
    /// Returns true if a circuit can charge it.
    pub fn takes_circuit(&self) -> bool {
        capacitance(self).is_some_and(|c| c.at_length(self.length()) > 0.0)
    }

    /// Returns true if its charge can be given.
    pub fn takes_charge(&self) -> bool {
        capacitance(self).is_some() && self.circuit.is_none()
    }
}

/// A lumped muscle whose electrodes have a charge instead of the voltage of a source.
#[derive(Clone, Copy, Debug)]
pub(super) struct Charged {
    pub(super) muscle: usize,
    capacitance: Capacitance,
    pub(super) place: ChargePlace,
}

/// Place of a charge.
#[derive(Clone, Copy, Debug)]
pub(super) enum ChargePlace {
    /// A coordinate, in the unit of the muscle.
    Coordinate(usize),
    /// A scalar of the intervals: an input.
    Input(usize),
}

impl Charged {
    /// Voltage Q/C in V at an instant and under the scalars of an interval beside it.
    pub(super) fn voltage(&self, model: &Model, instant: &Configuration, scalars: &[f64]) -> f64 {
        let charge = match self.place {
            ChargePlace::Coordinate(coordinate) => {
                instant.z[coordinate] * self.capacitance.unit_of_charge()
            }
            ChargePlace::Input(scalar) => scalars[scalar],
        };
        let length = instant.x[model.spans[self.muscle]].norm();
        charge / self.capacitance.at_length(length)
    }
}

impl Model {
    /// Muscles behind circuits, then those whose charge is given.
    pub(super) fn charged(&self) -> impl Iterator<Item = Charged> + '_ {
        let behind = self.internal_kinds().filter_map(|(coordinate, kind)| {
            let InternalKind::Charge(muscle) = kind else {
                return None;
            };
            Some((muscle, ChargePlace::Coordinate(coordinate)))
        });
        let loads = &self.system.components.loads;
        let given = (self.sources.len() - loads.len()..).zip(loads);
        let given = given.filter_map(|(source, load)| {
            let LoadPlace::Muscle(muscle) = load.on else {
                return None;
            };
            Some((muscle, ChargePlace::Input(self.variables.input(source)?)))
        });
        behind.chain(given).filter_map(|(muscle, place)| {
            let capacitance = capacitance(&self.system.muscles[muscle])?;
            Some(Charged {
                muscle,
                capacitance,
                place,
            })
        })
    }

    /// The muscle whose charge coordinate `i` is.
    pub fn charge(&self, i: usize) -> Option<usize> {
        match self.internal_kind(i)? {
            InternalKind::Charge(muscle) => Some(muscle),
            InternalKind::Joint(_) | InternalKind::Branch { .. } => None,
        }
    }

    /// Charge in mC of each muscle behind a circuit at instants with coordinates z.
    pub fn circuit_charges(&self, z: &[Vec<f64>]) -> BTreeMap<usize, Vec<f64>> {
        let of_circuit = |charged: Charged| match charged.place {
            ChargePlace::Coordinate(coordinate) => {
                let unit = charged.capacitance.unit_of_charge();
                let charges = z.iter().map(|z| z[coordinate] * unit);
                Some((charged.muscle, charges.collect()))
            }
            ChargePlace::Input(_) => None,
        };
        self.charged().filter_map(of_circuit).collect()
    }

    /// Names of the columns of [`electrode_voltages`](Self::electrode_voltages).
    pub fn electrodes(&self) -> impl Iterator<Item = String> + '_ {
        let name =
            |charged: Charged| format!("{}_voltage", self.system.muscles[charged.muscle].name);
        self.charged().map(name)
    }

    /// Voltage Q/C in V of each muscle with a charge Q instead of the voltage of a source, at an instant and under the scalars of an
    /// interval beside it.
    pub fn electrode_voltages(&self, instant: &Configuration, scalars: &[f64]) -> Vec<f64> {
        let voltage = |charged: Charged| charged.voltage(self, instant, scalars);
        self.charged().map(voltage).collect()
    }
}
