//! Circuits between the sources of finite elements and their electrodes: electrodes behind a resistor have a potential of their own.

use crate::model::system::circuit::Circuit;
use crate::model::system::{Electrode, Fidelity, Muscle, Potential, System};

/// Electrodes behind the resistor of a source.
#[derive(Clone, Debug, PartialEq)]
pub struct ElectrodeCircuit {
    /// The source.
    pub(crate) source: usize,
    pub(crate) name: String,
    pub(crate) circuit: Circuit,
    /// Scalar of the voltage of the source.
    pub(crate) input: usize,
    /// Scalar of their potential, and its unit in V.
    pub(crate) potential: (usize, f64),
    /// Unit of their charge in mC.
    pub(crate) unit_of_charge: f64,
}

impl System {
    /// The circuit between a source and electrodes of finite elements.
    pub fn electrode_circuit(&self, source: usize) -> Option<Circuit> {
        let of_muscle = |muscle: &Muscle| muscle.circuit.filter(|_| muscle.is_meshed());
        let is_own = |electrode: &&Electrode| matches!(electrode.potential, Potential::Driven { source: of, .. } if of == source);
        match self.muscles.get(source) {
            Some(muscle) => of_muscle(muscle),
            None => {
                let mut electrodes = self.solids.iter().flat_map(|solid| &solid.electrodes);
                electrodes.find(is_own)?.circuit
            }
        }
    }

    /// Returns true if electrodes of finite elements are behind a resistor of a source.
    pub fn has_electrodes_behind_resistor(&self, source: usize) -> bool {
        let circuit = self.electrode_circuit(source);
        circuit.is_some_and(|circuit| circuit.resistance.is_some())
    }

    /// Part of the voltage of a source that its circuit leaves to what it drives at rest.
    pub fn division(&self, source: usize) -> f64 {
        let of_muscle = self.muscles.get(source).and_then(|muscle| muscle.circuit);
        let circuit = of_muscle.or_else(|| self.electrode_circuit(source));
        circuit.as_ref().and_then(Circuit::division).unwrap_or(1.0)
    }
}

impl Electrode {
    /// Returns true if a source drives it.
    pub fn is_driven(&self) -> bool {
        matches!(self.potential, Potential::Driven { .. })
    }
}

impl Muscle {
    /// Returns true if it consists of finite elements.
    pub fn is_meshed(&self) -> bool {
        matches!(self.fidelity, Fidelity::FiniteElements(_))
    }
}

impl ElectrodeCircuit {
    /// Name of the source.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Voltage of the electrodes in V under scalars of an interval.
    pub fn voltage(&self, scalars: &[f64]) -> f64 {
        let (potential, unit) = self.potential;
        scalars[potential] * unit
    }

    /// Voltage of the electrodes in V, current in A and power in W of the source, at a voltage of the electrodes and under scalars of an interval.
    pub fn flow(&self, across: f64, scalars: &[f64]) -> [f64; 3] {
        let voltage = scalars[self.input];
        let current = (voltage - across) / self.circuit.resistance.unwrap_or(1.0);
        [across, current, voltage * current]
    }
}
