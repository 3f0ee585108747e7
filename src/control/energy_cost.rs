//! Costs of energies: the energy from the sources of lumped muscles, and the work of their electrical forces.

use crate::model::System;
use crate::model::components::capacitance;

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
    /// Returns true if the source is that of a lumped muscle with electric constants, without a circuit, whose electrodes have its voltage.
    pub fn exists(&self, system: &System) -> bool {
        let muscle = system.muscles.get(self.source);
        let is_direct = muscle.is_some_and(|muscle| muscle.circuit.is_none());
        let has_capacitance = muscle.and_then(capacitance).is_some();
        has_capacitance && is_direct && !system.is_charged(self.source)
    }
}

/// The sources whose energies are minimised, each once.
pub(super) fn sources(costs: &[EnergyCost]) -> Vec<usize> {
    let mut sources: Vec<usize> = costs.iter().map(|cost| cost.source).collect();
    sources.sort_unstable();
    sources.dedup();
    sources
}
