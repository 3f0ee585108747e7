//! Measure of the force with which a spring or a tendon pulls its ends together: the forces of its own terms along its span.

use crate::functional::{Displacement, Impulse, Measure, Term, TermKind};
use crate::kinematics::Vectors;
use crate::model::components::Kind;
use crate::model::measures::Known;
use crate::model::quantity::Pulling;
use crate::model::term_order::rank;
use crate::model::variables::Time;
use std::sync::Arc;

impl Known<'_> {
    /// Impulse of the forces of a part along its span in an interval; none where nothing changes its length.
    pub(super) fn pull(&self, part: Pulling, vectors: &mut Vectors) -> Option<Box<dyn Measure>> {
        let mut terms = self.no_terms(vectors);
        let components = &self.system.components;
        let (span, factor) = match part {
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
