//! Measures of the forces with which parts pull their ends together and joints act: the forces of their own terms along a displacement.

use crate::functional::{Displacement, Impulse, Measure, Shortening, Stencil, Term, TermKind};
use crate::math::Vector;
use crate::model::components::body::DAMPING;
use crate::model::components::{circuit, muscle};
use crate::model::constants::constant::Constant;
use crate::model::constants::free_parameters::MovedPoints;
use crate::model::layout::joint_sections::JointSection;
use crate::model::layout::variables::Time;
use crate::model::quantities::measures::{Made, Reading};
use crate::model::quantities::what::{Pulling, Reaction};
use crate::model::system::{Attachment, Fidelity};
use crate::model::term_order::rank;
use crate::model::terms::loads;
use std::sync::Arc;

/// A span of a part: its vector, its ends, the constants that are the components of their places, and how often the part has it.
struct Span {
    vector: usize,
    ends: [Attachment; 2],
    places: Box<dyn Fn(usize, usize) -> Constant>,
    times: usize,
}

impl Reading<'_, '_> {
    /// Mean force in the intervals with which a part pulls its ends together; none where nothing changes it.
    pub(super) fn tension(&mut self, part: Pulling) -> Made {
        let known = self.known;
        let mut terms = known.no_terms(self.vectors);
        let components = &known.system.components;
        let span = match part {
            Pulling::Muscle(index) => {
                let muscle = &known.system.muscles[index];
                if muscle.fidelity != Fidelity::Lumped {
                    return None;
                }
                muscle::forces(known, index, &mut terms);
                circuit::circuit(known, index, &mut terms);
                loads::charge_muscle(known, index, &mut terms);
                Span {
                    vector: known.spans[index],
                    ends: [muscle.from, muscle.to],
                    places: Box::new(move |end, axis| Constant::End(index, end, axis)),
                    times: 1,
                }
            }
            Pulling::Spring(index) => {
                let spring = &components.springs[index];
                spring.add(Some(index), &mut terms);
                Span {
                    vector: terms.span(&spring.from, &spring.to)?,
                    ends: [spring.from, spring.to],
                    places: Box::new(move |end, axis| Constant::SpringEnd(index, end, axis)),
                    times: 1,
                }
            }
            Pulling::Tendon(index) => {
                let tendon = &components.tendons[index];
                tendon.add(Some(index), &mut terms);
                let pairs = tendon.through.windows(2);
                let spans: Vec<_> = pairs.map(|pair| terms.span(&pair[0], &pair[1])).collect();
                // One tension along all of it.
                let first = spans.iter().position(Option::is_some)?;
                let place = move |end: usize, axis| Constant::TendonPoint(index, first + end, axis);
                Span {
                    vector: spans[first]?,
                    ends: [tendon.through[first], tendon.through[first + 1]],
                    places: Box::new(place),
                    times: spans.iter().filter(|span| **span == spans[first]).count(),
                }
            }
        };
        let mut read = terms.sought().read();
        let moved = MovedPoints {
            parts: [-1.0, 1.0],
            bodies: span.ends.each_ref().map(|end| terms.carrier(end)),
            places: Some(&*span.places),
        };
        read.moves(0, moved, |vector| terms.vector(vector));
        let (parameters, moves) = read.with_moves();
        let (terms, ..) = terms.finish(rank);
        let pulling = terms.iter().filter(|term| term.kind() != TermKind::Kinetic);
        let pulling: Vec<_> = pulling.collect();
        let displacement = Displacement::Shortening(Shortening {
            span: span.vector,
            factor: 1.0 / (span.times as f64 * self.quantity.unit),
            parameters,
            moves,
        });
        let measure = self.impulse(&pulling, displacement, 0);
        let mut vectors = measure.vectors().into_iter();
        let is_changed = !measure.scalars().is_empty() || vectors.any(|v| self.vectors.moves(v));
        is_changed.then_some(measure)
    }

    fn impulse(
        &self,
        terms: &[&Arc<dyn Term>],
        displacement: Displacement,
        side: usize,
    ) -> Box<dyn Measure> {
        let scalars = self.known.variables.of(Time::Interval).len();
        let counts = [self.vectors.list().len(), scalars];
        Box::new(Impulse::new(terms, counts, displacement, side))
    }

    /// Impulse of a joint along a direction, or its moment about the joint, at the start of an interval, or minus that at its end.
    pub(super) fn reaction(&mut self, joint: usize, of: Reaction, along: Vector) -> Made {
        let known = self.known;
        let kept = known.presolved.joint(joint).filter(|_| !self.is_glued)?;
        let section = JointSection::new(known.system, known.presolved, known.reference, kept)?;
        let (side, axis) = match self.quantity.at.stencil() {
            Stencil::Next => (1, -along),
            _ => (0, along),
        };
        let displacement = match of {
            Reaction::Force => {
                let moved = self.vectors.list().iter();
                let moved = moved.map(|vector| section.displacement(vector, &axis));
                Displacement::Shift(moved.collect())
            }
            Reaction::Torque if !section.has_torque => return None,
            Reaction::Torque => {
                let turns = section.turns(self.vectors);
                Displacement::Turn { axis, turns }
            }
        };
        let terms = self.terms.iter().filter(|term| term.name() != DAMPING);
        let terms: Vec<_> = terms.collect();
        Some(self.impulse(&terms, displacement, side))
    }
}
