//! Measures of the forces with which parts pull their ends together and joints act: the forces of their own terms along a displacement.

use crate::energy::{ElasticConstants, GivenCharge, Law, NeoHooke, SpanTension, ViscousTension};
use crate::functional::{
    Displacement, Impulse, LawElement, Measure, Stencil, Sum, Term, TermKind, VectorArg,
};
use crate::math::Vector;
use crate::model::components::body::DAMPING;
use crate::model::components::muscle_constants::MuscleConstants;
use crate::model::layout::internal::InternalKind;
use crate::model::layout::joint_sections::JointSection;
use crate::model::layout::variables::Time;
use crate::model::quantities::measures::{Made, Reading, Shape};
use crate::model::quantities::what::{Pulling, Reaction};
use crate::model::system::Fidelity;
use crate::model::term_order::rank;
use std::sync::Arc;

impl Reading<'_, '_> {
    /// Impulse of the forces of a spring or tendon along its span in an interval; none where nothing changes its length.
    pub(super) fn pull(&mut self, part: Pulling) -> Made {
        let mut terms = self.known.no_terms(self.vectors);
        let components = &self.known.system.components;
        let (span, factor) = match part {
            Pulling::Muscle(_) => return None,
            Pulling::Spring(index) => {
                let spring = &components.springs[index];
                let span = terms.span(&spring.from, &spring.to)?;
                spring.add(Some(index), &mut terms);
                (span, 1.0)
            }
            Pulling::Tendon(index) => {
                let tendon = &components.tendons[index];
                let pairs = tendon.through.windows(2);
                let spans: Vec<usize> = pairs
                    .filter_map(|pair| terms.span(&pair[0], &pair[1]))
                    .collect();
                tendon.add(Some(index), &mut terms);
                // One tension along all of it.
                let span = *spans.first()?;
                let times = spans.iter().filter(|other| **other == span).count();
                (span, 1.0 / times as f64)
            }
        };
        let (terms, ..) = terms.finish(rank);
        let pulling = terms.iter().filter(|term| term.kind() != TermKind::Kinetic);
        let pulling: Vec<_> = pulling.collect();
        let displacement = Displacement::Shortening { span, factor };
        let measure = self.impulse(&pulling, displacement, 0);
        (!pulling.is_empty()).then_some(measure)
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

/// The parts of a tension in a unit in N.
struct Parts {
    unit: f64,
    list: Vec<Box<dyn Measure>>,
}

impl Parts {
    fn add<L: Law<M>, const M: usize, const NV: usize, const NS: usize>(
        &mut self,
        element: LawElement<L, M, NV, NS>,
    ) {
        self.list.push(Shape::Linear.law(1.0 / self.unit, element));
    }

    /// Adds the force of elasticity, with that of a voltage, by a law of elasticity.
    fn add_cell<L: ElasticConstants>(
        &mut self,
        of: &MuscleConstants<'_>,
        law: L,
        span: VectorArg,
        voltage: Option<usize>,
    ) {
        match (of.muscle().material.electric, voltage) {
            (Some(electric), Some(voltage)) => {
                let force = |of: &mut MuscleConstants<'_>| SpanTension(of.driven(electric, law));
                self.add::<_, 4, 1, 1>(of.with(force, [span], [voltage]));
            }
            _ => {
                let force = |of: &mut MuscleConstants<'_>| SpanTension(of.elastic(law));
                self.add::<_, 3, 1, 0>(of.with(force, [span], []));
            }
        }
    }
}

impl Reading<'_, '_> {
    /// Tension of a lumped muscle that moves or has a voltage, in the middle of the intervals.
    pub(super) fn tension(&mut self, index: usize) -> Made {
        let known = self.known;
        let muscle = &known.presolved.system.muscles[index];
        let charge = known.internals.vector(InternalKind::Charge(index));
        let given = known.system.charge_of(index);
        let given = given.and_then(|source| known.variables.input(source));
        let voltage = known.variables.input(index).filter(|_| charge.is_none());
        let is_changed = charge.is_some() || given.is_some() || voltage.is_some();
        if muscle.fidelity != Fidelity::Lumped || !(is_changed || known.presolved.moves(muscle)) {
            return None;
        }
        let of = self.muscle(index);
        let span = self.span(index);
        let [middle, rate] = [Stencil::Mid, Stencil::Rate].map(|stencil| stencil.of(span));
        let mut parts = Parts {
            unit: self.quantity.unit,
            list: Vec::new(),
        };
        match muscle.material.law {
            None => parts.add_cell(&of, NeoHooke, middle, voltage),
            Some(law) => {
                let mut of = of.clone();
                let law = of.law(law);
                parts.add_cell(&of, law, middle, voltage);
            }
        }
        let mut electric = of.clone();
        if let Some((charge, energy)) = charge.zip(electric.flowing_charge()) {
            let energy = SpanTension(energy);
            let vectors = [middle, Stencil::Mid.of(self.vectors.index(charge))];
            parts.add::<_, 6, 2, 0>(electric.element(energy, vectors, []));
        }
        let mut electric = of.clone();
        if let Some((charge, capacitance)) = given.zip(electric.capacitance()) {
            let energy = SpanTension(GivenCharge { capacitance });
            parts.add::<_, 4, 1, 1>(electric.element(energy, [middle], [charge]));
        }
        for (branch, constants) in muscle.material.maxwell.list().iter().enumerate() {
            let kind = InternalKind::Branch {
                muscle: index,
                branch,
            };
            if let Some(viscous) = known.internals.vector(kind) {
                let vectors = [middle, Stencil::Mid.of(self.vectors.index(viscous))];
                let force =
                    |of: &mut MuscleConstants<'_>| SpanTension(of.branch_spring(branch, constants));
                parts.add::<_, 6, 2, 0>(of.with(force, vectors, []));
            }
        }
        if let Some(viscosity) = muscle.material.viscosity {
            let force = |of: &mut MuscleConstants<'_>| ViscousTension(of.viscous(viscosity));
            parts.add::<_, 6, 2, 0>(of.with(force, [middle, rate], []));
        }
        Some(match self.shape {
            Shape::Linear => Box::new(Sum::linear(parts.list)),
            Shape::Curved => Box::new(Sum::curved(parts.list)),
        })
    }
}
