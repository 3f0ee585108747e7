//! Energies of one interval, term by term.

use crate::coordinates::Configuration;
use crate::functional::{Sample, Term, TermKind};
use crate::model::Model;

/// Energies of one interval at its midpoint, in mJ.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Energies {
    /// Kinetic energy.
    pub kinetic: f64,
    /// Potential energy of each term that has one, part by part, in the order of the terms.
    pub potential: Vec<f64>,
    /// Work that forces without a potential do over the interval.
    pub work: Work,
}

/// Work of forces without a potential, in mJ.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Work {
    /// Of loads that follow what they act on.
    pub applied: f64,
    /// Of forces that dissipate energy; not positive.
    pub dissipation: f64,
}

impl Work {
    /// Adds `weight` times the work of a term at a sample; nothing where the term has a potential.
    pub fn add(&mut self, weight: f64, term: &dyn Term, sample: &Sample<'_>) {
        match term.kind() {
            TermKind::AppliedWork => self.applied += weight * term.energy(sample),
            TermKind::Dissipation => self.dissipation += weight * term.energy(sample),
            TermKind::Kinetic | TermKind::Potential | TermKind::Constraint => {}
        }
    }
}

impl Energies {
    /// Kinetic plus potential energy.
    pub fn total(&self) -> f64 {
        self.kinetic + self.potential.iter().sum::<f64>()
    }
}

/// Energies of the interval of `h` ms between two placed instants under voltages by scalar.
pub fn energies(
    model: &Model,
    a: &Configuration,
    b: &Configuration,
    scalars: &[f64],
    h: f64,
) -> Energies {
    let interval = Sample::of_interval(scalars, h);
    let sample = interval.between([a, b]);
    let mut energies = Energies::default();
    for term in &model.action.intervals.terms {
        energies.work.add(1.0, term.as_ref(), &sample);
        match term.kind() {
            TermKind::Kinetic => energies.kinetic += term.energy(&sample),
            TermKind::Potential => term.energies(&sample, &mut energies.potential),
            TermKind::AppliedWork | TermKind::Dissipation | TermKind::Constraint => {}
        }
    }
    energies
}
