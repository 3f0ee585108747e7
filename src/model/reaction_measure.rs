//! Measure of the force or torque that a joint transmits: the impulse that is missing in the balance of the bodies on one side of it.

use crate::functional::{Displacement, Impulse, Measure, Stencil};
use crate::kinematics::Vectors;
use crate::math::Vector;
use crate::model::dampers::DAMPING;
use crate::model::joint_sections::JointSection;
use crate::model::measures::Known;
use crate::model::quantity::Reaction;
use crate::model::variables::Time;

impl Known<'_> {
    /// Impulse of a joint along a direction, or its moment about the joint, at the start of an interval, or minus that at its end.
    pub(super) fn reaction(
        &self,
        (joint, of): (usize, Reaction),
        (along, at): (Vector, Stencil),
        vectors: &mut Vectors,
    ) -> Option<Box<dyn Measure>> {
        let kept = self.presolved.joint(joint).filter(|_| !self.is_glued)?;
        let section = JointSection::new((self.system, self.presolved), self.reference, kept)?;
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
