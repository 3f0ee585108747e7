//! Energies of one interval, term by term.

use crate::coordinates::{Configuration, Interval};
use crate::functional::TermKind;
use crate::model::Model;

/// Energies of one interval at its midpoint, in mJ.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Energies {
    /// Kinetic energy.
    pub kinetic: f64,
    /// Potential energy of each term that has one, part by part, in the order of the terms.
    pub potential: Vec<f64>,
    /// Work that forces without a potential do over the interval.
    pub work: f64,
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
    let interval = Interval::given(scalars, h);
    let sample = interval.sample([a, b]);
    let mut energies = Energies::default();
    for term in &model.action.intervals.terms {
        match term.kind() {
            TermKind::Kinetic => energies.kinetic += term.energy(&sample),
            TermKind::Potential => term.energies(&sample, &mut energies.potential),
            TermKind::VirtualWork => energies.work += term.energy(&sample),
            TermKind::Constraint => {}
        }
    }
    energies
}
