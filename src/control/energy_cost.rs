//! Costs of energies: the energy from the sources of lumped muscles, and the work of their electrical forces.

use crate::model::components::capacitance;
use crate::model::system::Muscle;
use crate::model::{Quantity, System};

/// An energy of one source that is minimised (docs/theory.md, 3.5).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EnergyCost {
    /// Index of the source, which is that of its lumped muscle.
    pub source: usize,
    /// Energy, summed over the motion.
    pub energy: SourceEnergy,
    /// Weight per J, positive.
    pub weight: f64,
}

/// An energy that a source and its muscle exchange with a motion.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SourceEnergy {
    /// Energy from the source to the muscle; energy that flows back is negative.
    Electrical,
    /// Work of the electrical forces.
    Mechanical,
}

impl EnergyCost {
    /// Returns true if the source is that of a lumped muscle with electric constants, without a circuit, whose electrodes have its voltage, or
    /// supplies electrical energy through a resistor.
    pub fn exists(&self, system: &System) -> bool {
        let muscle = system.muscles.get(self.source);
        let is_direct = muscle.is_some_and(|muscle| muscle.circuit.is_none());
        let is_supplied = self.energy == SourceEnergy::Electrical && self.is_resisted(system);
        let has_capacitance = muscle.and_then(capacitance).is_some();
        has_capacitance && (is_direct || is_supplied) && !system.is_charged(self.source)
    }

    /// Returns true if it is the energy that a source supplies through a resistor: the integral of its power.
    pub(super) fn is_resisted(&self, system: &System) -> bool {
        let muscle = system.muscles.get(self.source);
        muscle.is_some_and(Muscle::is_behind_resistor)
    }

    /// The power of its source in W, through a resistor.
    pub(super) fn power(&self) -> Quantity {
        let muscle = self.source;
        Quantity::SourcePower { muscle, unit: 1.0 }
    }
}

/// The sources without resistors whose energies are minimised, each once.
pub(super) fn sources(costs: &[EnergyCost], system: &System) -> Vec<usize> {
    let direct = costs.iter().filter(|cost| !cost.is_resisted(system));
    let mut sources: Vec<usize> = direct.map(|cost| cost.source).collect();
    sources.sort_unstable();
    sources.dedup();
    sources
}

/// The energies that flow through resistors.
pub(super) fn resisted<'a>(
    costs: &'a [EnergyCost],
    system: &'a System,
) -> impl Iterator<Item = &'a EnergyCost> {
    costs.iter().filter(|cost| cost.is_resisted(system))
}
