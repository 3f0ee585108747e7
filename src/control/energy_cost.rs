//! Costs of energies: what the sources of lumped muscles give, and what their electrical forces work.

use crate::model::System;
use crate::model::components::capacitance;

/// An energy of one source that is minimised (docs/theory.md, 3.5).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EnergyCost {
    /// Index of the source, which is that of its lumped muscle.
    pub source: usize,
    /// Which energy, summed over the motion.
    pub energy: SourceEnergy,
    /// Weight per J, positive.
    pub weight: f64,
}

/// An energy that a source and its muscle exchange with a motion.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SourceEnergy {
    /// From the source to the muscle; what flows back is negative.
    Electrical,
    /// Work of the electrical forces.
    Mechanical,
}

impl EnergyCost {
    /// Whether the source is that of a lumped muscle with electric constants.
    pub fn exists(&self, system: &System) -> bool {
        let muscle = system.muscles.get(self.source);
        muscle.and_then(capacitance).is_some()
    }
}

/// The sources whose energies are minimised, each once.
pub(super) fn sources(costs: &[EnergyCost]) -> Vec<usize> {
    let mut sources: Vec<usize> = costs.iter().map(|cost| cost.source).collect();
    sources.sort_unstable();
    sources.dedup();
    sources
}
