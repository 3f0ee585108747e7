//! Measures of lumped muscles: stretch and field.

use crate::functional::{Law, Measure, Stencil};
use crate::kinematics::{MaterialVector, Vectors};
use crate::model::components::measured_laws::GivenField;
use crate::model::components::muscle_constants::MuscleConstants;
use crate::model::measures::{Known, Shape, instant, read};

impl Known<'_> {
    /// Squared stretch of a muscle, at the instants or at a place of the intervals.
    pub(super) fn stretch(
        &self,
        muscle: usize,
        at: Option<Stencil>,
        shape: Shape,
        vectors: &mut Vectors,
    ) -> Box<dyn Measure> {
        let span = self.span(muscle, vectors);
        match at {
            None => {
                let stretch = MuscleConstants::given(&self.presolved.system.muscles[muscle]);
                instant(shape, stretch.stretch().formula(&[]), [span])
            }
            Some(at) => {
                let of = self.muscle(muscle, vectors);
                let stretch = of.stretch();
                shape.law::<_, 3, 1, 0>(of.element(stretch, [read(span, at)], []))
            }
        }
    }

    /// Squared field of a lumped muscle over the one of its `limit`.
    pub(super) fn muscle_field(
        &self,
        muscle: usize,
        (limit, at): (f64, Stencil),
        shape: Shape,
        vectors: &mut Vectors,
    ) -> Option<Box<dyn Measure>> {
        let span = [read(self.span(muscle, vectors), at)];
        let mut of = self.muscle(muscle, vectors);
        if let Some(source) = self.system.charge_of(muscle) {
            let charge = [self.variables.input(source)?];
            let capacitance = of.capacitance()?;
            let field = GivenField { capacitance, limit };
            return Some(shape.law(of.element(field, span, charge)));
        }
        let voltage = [self.variables.input(muscle)?];
        let field = of.field(limit);
        Some(shape.law(of.element(field, span, voltage)))
    }

    /// The constants of a muscle, whose span is the first vector of an element.
    pub(super) fn muscle(&self, index: usize, vectors: &mut Vectors) -> MuscleConstants<'_> {
        let muscle = &self.presolved.system.muscles[index];
        let read = self.sought.read();
        let bodies = [muscle.from.body, muscle.to.body];
        MuscleConstants::new((muscle, index), (read, [-1.0, 1.0]), bodies, |moved| {
            vectors.index(moved)
        })
    }

    /// Vector of the span of a muscle.
    pub(super) fn span(&self, muscle: usize, vectors: &mut Vectors) -> usize {
        let muscle = &self.presolved.system.muscles[muscle];
        let [from, to] = [&muscle.from, &muscle.to]
            .map(|a| MaterialVector::point(a.body, &a.at, self.reference));
        vectors.index(MaterialVector::span(&from, &to))
    }
}
