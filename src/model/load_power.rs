//! Power of loads: forces and torques times the rates of the places where they act.

use crate::functional::{Sample, Term, TermKind};
use crate::math::Vector;
use crate::model::loads::LOADS;
use crate::model::model::Model;
use crate::model::system::InputKind;

impl Model {
    /// Sources that are loads of a force or torque that acts on what moves, each with its scalar of the intervals.
    pub fn working_loads(&self) -> Vec<(usize, usize)> {
        let sources = self.sources.iter().enumerate();
        let forces = sources.filter(|(_, source)| match source.kind {
            InputKind::Force | InputKind::Torque | InputKind::Traction | InputKind::BodyForce => {
                true
            }
            InputKind::Voltage | InputKind::SurfaceCharge | InputKind::Charge => false,
        });
        forces
            .filter_map(|(source, _)| Some((source, self.variables.input(source)?)))
            .collect()
    }

    /// Power in W of the load with a scalar, at places x of the vectors with their rates.
    pub fn load_power(&self, scalar: usize, [x, rates]: [&[Vector]; 2], scalars: &[f64]) -> f64 {
        let mut alone = vec![0.0; scalars.len()];
        alone[scalar] = scalars[scalar];
        // An interval of 1 ms with these places in its middle and these rates.
        let at =
            |part: f64| -> Vec<Vector> { x.iter().zip(rates).map(|(x, v)| x + v * part).collect() };
        let (a, b) = (at(-0.5), at(0.5));
        let sample = |vectors| Sample {
            vectors,
            ..Sample::of_instant(&a, &alone)
        };
        let power = |term: &dyn Term| match term.kind() {
            TermKind::AppliedWork => term.energy(&sample([&a, &b])),
            // The potential is linear in places.
            TermKind::Potential if term.name() == LOADS => {
                term.energy(&sample([&a, &a])) - term.energy(&sample([&b, &b]))
            }
            _ => 0.0,
        };
        let terms = self.action.intervals.terms.iter();
        terms.map(|term| power(term.as_ref())).sum()
    }
}
