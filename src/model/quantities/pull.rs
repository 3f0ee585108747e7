//! Measure of the force with which a spring or a tendon pulls its ends together: the forces of its own terms along its span.

use crate::energy::{ElasticConstants, GivenCharge, Law, NeoHooke, SpanTension, ViscousTension};
use crate::functional::{
    Displacement, Impulse, LawElement, Measure, Stencil, Sum, Term, TermKind, VectorArg,
};
use crate::kinematics::Vectors;
use crate::math::Vector;
use crate::model::components::Kind;
use crate::model::components::muscle_constants::MuscleConstants;
use crate::model::layout::internal::InternalKind;
use crate::model::layout::joint_sections::JointSection;
use crate::model::layout::variables::Time;
use crate::model::quantities::measures::{Known, Shape};
use crate::model::quantities::what::{Pulling, Reaction};
use crate::model::system::Fidelity;
use crate::model::term_order::rank;
use crate::model::terms::joint_constraints::DAMPING;
use std::sync::Arc;

impl Known<'_> {
    /// Impulse of the forces of a spring or tendon along its span in an interval; none where nothing changes its length.
    pub(crate) fn pull(&self, part: Pulling, vectors: &mut Vectors) -> Option<Box<dyn Measure>> {
        let mut terms = self.no_terms(vectors);
        let components = &self.system.components;
        let (span, factor) = match part {
            Pulling::Muscle(_) => return None,
            Pulling::Spring(index) => {
                let spring = &components.springs[index];
                let span = terms.span(&spring.from, &spring.to)?;
                spring.build_at(index, &mut terms);
                (span, 1.0)
            }
            Pulling::Tendon(index) => {
                let tendon = &components.tendons[index];
                let pairs = tendon.through.windows(2);
                let spans: Vec<usize> = pairs
                    .filter_map(|pair| terms.span(&pair[0], &pair[1]))
                    .collect();
                tendon.build_at(index, &mut terms);
                // One tension along all of it.
                let span = *spans.first()?;
                let times = spans.iter().filter(|other| **other == span).count();
                (span, 1.0 / times as f64)
            }
        };
        let (terms, ..) = terms.finish(rank);
        let terms: Vec<Arc<dyn Term>> = terms.into_iter().map(Arc::from).collect();
        let pulling = terms.iter().filter(|term| term.kind() != TermKind::Kinetic);
        let counts = [
            vectors.list().len(),
            self.variables.of(Time::Interval).len(),
        ];
        let displacement = Displacement::Shortening { span, factor };
        let pulling: Vec<_> = pulling.collect();
        let measure = Impulse::new(&pulling, counts, displacement, 0);
        (!pulling.is_empty()).then(|| Box::new(measure) as Box<dyn Measure>)
    }
}

impl Known<'_> {
    /// Impulse of a joint along a direction, or its moment about the joint, at the start of an interval, or minus that at its end.
    pub(crate) fn reaction(
        &self,
        joint: usize,
        of: Reaction,
        along: Vector,
        at: Stencil,
        vectors: &mut Vectors,
    ) -> Option<Box<dyn Measure>> {
        let kept = self.presolved.joint(joint).filter(|_| !self.is_glued)?;
        let section = JointSection::new(self.system, self.presolved, self.reference, kept)?;
        let (side, direction) = match at {
            Stencil::Next => (1, -along),
            _ => (0, along),
        };
        let displacement = match of {
            Reaction::Force => {
                let moved = vectors.list().iter();
                let moved = moved.map(|vector| section.displacement(vector, &direction));
                Displacement::Shift(moved.collect())
            }
            Reaction::Torque if !section.has_torque => return None,
            Reaction::Torque => {
                let turns = section.turns(vectors);
                Displacement::Turn {
                    axis: direction,
                    turns,
                }
            }
        };
        let terms = self.terms.iter().filter(|term| term.name() != DAMPING);
        let counts = [
            vectors.list().len(),
            self.variables.of(Time::Interval).len(),
        ];
        let terms: Vec<_> = terms.collect();
        Some(Box::new(Impulse::new(&terms, counts, displacement, side)))
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
        element: LawElement<L, NV, NS>,
    ) {
        let part = Shape::Linear.scaled_law(1.0 / self.unit, element);
        self.list.push(part);
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

impl Known<'_> {
    /// Tension of a lumped muscle that moves or has a voltage, in a unit in N, in the middle of the intervals.
    pub(crate) fn tension(
        &self,
        index: usize,
        unit: f64,
        shape: Shape,
        vectors: &mut Vectors,
    ) -> Option<Box<dyn Measure>> {
        let muscle = &self.presolved.system.muscles[index];
        let charge = self.internals.vector(InternalKind::Charge(index));
        let given = self.system.charge_of(index);
        let given = given.and_then(|source| self.variables.input(source));
        let voltage = self.variables.input(index).filter(|_| charge.is_none());
        let is_changed = charge.is_some() || given.is_some() || voltage.is_some();
        if muscle.fidelity != Fidelity::Lumped || !(is_changed || self.presolved.moves(muscle)) {
            return None;
        }
        let of = self.muscle(index, vectors);
        let span = self.span(index, vectors);
        let [middle, rate] = [Stencil::Mid, Stencil::Rate].map(|stencil| stencil.of(span));
        let mut parts = Parts {
            unit,
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
            let vectors = [middle, Stencil::Mid.of(vectors.index(charge))];
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
            if let Some(viscous) = self.internals.vector(kind) {
                let vectors = [middle, Stencil::Mid.of(vectors.index(viscous))];
                let force =
                    |of: &mut MuscleConstants<'_>| SpanTension(of.branch_spring(branch, constants));
                parts.add::<_, 6, 2, 0>(of.with(force, vectors, []));
            }
        }
        if let Some(viscosity) = muscle.material.viscosity {
            let force = |of: &mut MuscleConstants<'_>| ViscousTension(of.viscous(viscosity));
            parts.add::<_, 6, 2, 0>(of.with(force, [middle, rate], []));
        }
        Some(match shape {
            Shape::Linear => Box::new(Sum::linear(parts.list)),
            Shape::Curved => Box::new(Sum::curved(parts.list)),
        })
    }
}
